/// \file
/// The closed set of material laws, and the laws of regions.
///
/// A law is a value with three pure functions of F = dx/dX: energy(F) [MPa = mJ/mm^3], its gradient
/// stress(F) (first Piola-Kirchhoff) [MPa], and the second derivative tangent(F) [MPa]; validate()
/// checks the constants. To add a law: one file in materials/, its name in the variant below, in
/// tests/fem/ its textbook energy (textbook_energy.h) and an example (material_examples.h), in
/// verify/ its stress in principal stretches (reference_laws.cpp) and an example
/// (example_laws.cpp), and its keys in decks (io/internal/read_law.cpp).
#pragma once

#include <lefort/fem/materials/decoupled_law.h>
#include <lefort/fem/materials/fung_orthotropic.h>
#include <lefort/fem/materials/holzapfel_gasser_ogden.h>
#include <lefort/fem/materials/isochoric_neo_hookean.h>
#include <lefort/fem/materials/linear_elastic.h>
#include <lefort/fem/materials/mooney_rivlin.h>
#include <lefort/fem/materials/neo_hookean.h>
#include <lefort/fem/materials/ogden.h>
#include <lefort/fem/materials/st_venant_kirchhoff.h>
#include <lefort/fem/materials/yeoh.h>

#include <cstdint>
#include <map>
#include <variant>

namespace lefort::fem {

/// Any material law.
using Material = std::variant<NeoHookean, LinearElastic, StVenantKirchhoff,  //
                              DecoupledLaw<IsochoricNeoHookean>, DecoupledLaw<MooneyRivlin>,
                              DecoupledLaw<Yeoh>, DecoupledLaw<Ogden>,
                              DecoupledLaw<FungOrthotropic>, DecoupledLaw<HolzapfelGasserOgden>>;

/// Law of each region of a mesh (mesh::ElementBlock::region).
using RegionMaterials = std::map<std::int32_t, Material>;

}  // namespace lefort::fem
