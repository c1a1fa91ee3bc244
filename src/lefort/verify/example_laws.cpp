#include <lefort/verify/example_laws.h>

namespace lefort::verify {

std::vector<NamedLaw> example_laws(double kappa_mpa) {
  const fem::Volumetric volume{.form = fem::VolumetricForm::kQuadraticLog, .kappa_mpa = kappa_mpa};
  fem::FungOrthotropic fung{.mu_mpa = {0.6, 0.4, 0.4}, .c_mpa = 3.0};
  fung.lambda_mpa << 0.3, 0.1, 0.1,  //
      0.1, 0.2, 0.05,                //
      0.1, 0.05, 0.2;
  const fem::HolzapfelGasserOgden fibers{
      .mu_mpa = 1.0, .k1_mpa = 0.4, .k2 = 0.1, .dispersion = 0.1, .family_count = 1};
  return {
      {"neo-Hookean", fem::NeoHookean{.mu_mpa = 1.0, .lambda_mpa = 4.0}},
      {"linear elastic", fem::LinearElastic{.mu_mpa = 1.0, .lambda_mpa = 0.5}},
      {"St Venant-Kirchhoff", fem::StVenantKirchhoff{.mu_mpa = 1.0, .lambda_mpa = 0.3}},
      {"isochoric neo-Hookean",
       fem::DecoupledLaw<fem::IsochoricNeoHookean>{.isochoric = {.mu_mpa = 1.0}, .volume = volume}},
      {"Mooney-Rivlin",
       fem::DecoupledLaw<fem::MooneyRivlin>{.isochoric = {.c10_mpa = 0.35, .c01_mpa = 0.15},
                                            .volume = volume}},
      {"Yeoh",
       fem::DecoupledLaw<fem::Yeoh>{
           .isochoric = {.c10_mpa = 0.5, .c20_mpa = -0.02, .c30_mpa = 0.005}, .volume = volume}},
      {"Ogden",
       fem::DecoupledLaw<fem::Ogden>{
           .isochoric = {.terms = {{{0.8, 1.3}, {0.02, 5.0}, {-0.2, -2.0}}}}, .volume = volume}},
      {"Fung orthotropic",
       fem::DecoupledLaw<fem::FungOrthotropic>{.isochoric = fung, .volume = volume}},
      {"Holzapfel-Gasser-Ogden",
       fem::DecoupledLaw<fem::HolzapfelGasserOgden>{.isochoric = fibers, .volume = volume}},
  };
}

}  // namespace lefort::verify
