/// \file
/// Pressure of hex20 at corners that belong to one element only.
#pragma once

#include <lefort/fem/elements/all_elements.h>

#include <array>

namespace lefort::fem {

/// Which corners of a hexahedron belong to no other element of its region.
using LoneCorners = std::array<bool, Hex8::kNodes>;

/// Pressure functions of a hexahedron, as combinations of its trilinear functions N.
///
/// A hex20 has no nodes in its faces. If three of its faces meet in a lone corner and are held, the
/// displacements of its other nodes do not control the pressure in that corner: it is a spurious
/// mode of the space of all N (`lefort verify --only inf-sup`). A lone corner has therefore no
/// pressure of its own. Its pressure is the mean of those of the corners at the other ends of its
/// edges that are not lone. The sum of the functions remains one.
///
/// \param is_lone  per corner.
/// \returns T, so that the pressure functions are T N. The row of a lone corner is zero, unless all
///   corners at the other ends of its edges are lone too: then it keeps its function.
[[nodiscard]] inline Eigen::Matrix<double, 8, 8> pressure_functions(const LoneCorners& is_lone) {
  static const auto kCorners = Hex8::nodes();
  Eigen::Matrix<double, 8, 8> T = Eigen::Matrix<double, 8, 8>::Identity();
  for (int a = 0; a < Hex8::kNodes; ++a) {
    if (!is_lone[std::size_t(a)]) continue;
    Eigen::Matrix<double, 8, 1> neighbors = Eigen::Matrix<double, 8, 1>::Zero();
    for (int b = 0; b < Hex8::kNodes; ++b) {
      const bool is_edge = (kCorners.col(a) - kCorners.col(b)).cwiseAbs().sum() == 2.0;
      if (is_edge && !is_lone[std::size_t(b)]) neighbors[b] = 1.0;
    }
    if (neighbors.sum() > 0.0) T.col(a) = neighbors / neighbors.sum();
  }
  return T;
}

/// Whether lone corners of this shape have no pressure of their own.
template <class Element>
inline constexpr bool kSharesLoneCorners = false;
template <>
inline constexpr bool kSharesLoneCorners<Hex20> = true;

}  // namespace lefort::fem
