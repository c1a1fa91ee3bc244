#include <lefort/fem/materials/material_response.h>

namespace lefort::fem {
namespace {

/// Calls f with the given part of the law.
template <class Function>
auto apply_law(const Material& material, LawPart part, const Function& f) {
  return std::visit(
      [&]<class Law>(const Law& law) {
        if constexpr (kIsDecoupled<Law>) {
          if (part == LawPart::kIsochoric) return f(law.isochoric);
        }
        return f(law);
      },
      material);
}

}  // namespace

const Volumetric* volumetric_part(const Material& material) {
  return std::visit(
      []<class Law>(const Law& law) -> const Volumetric* {
        if constexpr (kIsDecoupled<Law>) return &law.volume;
        return nullptr;
      },
      material);
}

Material with_bulk_modulus(Material material, double kappa_mpa) {
  std::visit(
      [&]<class Law>(Law& law) {
        if constexpr (kIsDecoupled<Law>) law.volume.kappa_mpa = kappa_mpa;
      },
      material);
  return material;
}

double energy(const Material& material, LawPart part, const Mat3& F) {
  return apply_law(material, part, [&](const auto& law) { return law.energy(F); });
}

Mat3 stress(const Material& material, LawPart part, const Mat3& F) {
  return apply_law(material, part, [&](const auto& law) { return law.stress(F); });
}

Mat9 tangent(const Material& material, LawPart part, const Mat3& F) {
  return apply_law(material, part, [&](const auto& law) { return law.tangent(F); });
}

double shear_modulus_at_rest(const Material& material) {
  const Mat9 A = tangent(material, LawPart::kIsochoric, Mat3::Identity());
  double sum = 0.0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (i != j) sum += A(i + 3 * j, i + 3 * j);  // dP_ij / dF_ij
  return sum / 6.0;
}

}  // namespace lefort::fem
