/// \file
/// A block and decks for tests to modify.
#pragma once

#include <lefort/solve/prepare_deck.h>

#include <vector>

#include "support/box_mesh.h"

namespace lefort::test {

inline constexpr fem::NeoHookean kBlockLaw{.mu_mpa = 0.01, .lambda_mpa = 0.04};

/// 10 x 10 x 20 mm.
inline mesh::VolumeMesh block(mesh::ElementShape shape = mesh::ElementShape::kTet4) {
  return box_mesh({.cells = {2, 2, 4}, .size_mm = {10, 10, 20}, .distortion = 0.1, .shape = shape});
}

inline solve::PrescribedSet prescribe(std::string set, std::optional<double> x_mm,
                                      std::optional<double> y_mm, std::optional<double> z_mm) {
  solve::PrescribedSet prescribed;
  prescribed.set = std::move(set);
  prescribed.displacement_mm = {x_mm, y_mm, z_mm};
  return prescribed;
}

/// Three planes of symmetry; the upper side moves along z.
inline solve::Deck uniaxial_deck(double stretch_mm) {
  solve::Deck deck;
  deck.laws.push_back({"", kBlockLaw, 0.0});
  deck.displacements = {prescribe("x0", 0.0, {}, {}), prescribe("y0", {}, 0.0, {}),
                        prescribe("z0", {}, {}, 0.0), prescribe("z1", {}, {}, stretch_mm)};
  return deck;
}

/// The lower side is fixed; there are no loads.
inline solve::Deck clamped_deck() {
  solve::Deck deck;
  deck.laws.push_back({"", kBlockLaw, 0.0});
  deck.displacements = {prescribe("z0", 0.0, 0.0, 0.0)};
  return deck;
}

}  // namespace lefort::test
