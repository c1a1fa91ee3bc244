/// \file
/// The parts of one element that take their strain together with those of its neighbors
/// (volumetric_integration.h).
#pragma once

#include <lefort/fem/elements/all_elements.h>
#include <lefort/fem/elements/reference_element.h>

#include <array>
#include <optional>

namespace lefort::fem {

/// How many a shape has; 0 where each element takes its own strain.
template <class Element>
inline constexpr int kSmoothingDomains = 0;
template <>
inline constexpr int kSmoothingDomains<Tet4> = 6;  ///< Its edges.
template <>
inline constexpr int kSmoothingDomains<Wedge6> = 6;  ///< Two on each upright face.

/// Each part stands for its share of the element's volume.
template <class Element>
using SmoothingDomains =
    std::array<ReferencePoint<Element>, std::size_t(kSmoothingDomains<Element>)>;

namespace internal {

/// A wedge, integrated at the middles of the triangle's sides, exact to degree 2, and at Gauss'
/// heights: on the upright faces. What lies along a face is the same in both elements there.
struct Wedge6OnFaces : Wedge6 {
  [[nodiscard]] static std::array<QuadraturePoint<kNodes>, kPoints> quadrature() {
    constexpr double kWeight = 1.0 / 6.0;
    const Rule<2, 3> middles{{{{0.5, 0.5}, kWeight}, {{0.5, 0.0}, kWeight}, {{0.0, 0.5}, kWeight}}};
    return at_points<Wedge6>(product(middles, gauss_2()));
  }
};

}  // namespace internal

/// \param X  reference positions of the nodes [mm].
/// \returns nothing if the element has no volume at one of them.
template <class Element>
[[nodiscard]] std::optional<SmoothingDomains<Element>> smoothing_domains(
    const ElementNodes<Element>& X);

/// The edges, in the order of Tet10::kEdges.
template <>
[[nodiscard]] inline std::optional<SmoothingDomains<Tet4>> smoothing_domains<Tet4>(
    const ElementNodes<Tet4>& X) {
  const auto points = reference_element<Tet4>(X);
  if (!points) return std::nullopt;
  ReferencePoint<Tet4> side = points->front();
  side.volume_mm3 /= kSmoothingDomains<Tet4>;
  SmoothingDomains<Tet4> sides;
  sides.fill(side);
  return sides;
}

/// The faces across from nodes 0, 1 and 2, first near the lower triangle.
template <>
[[nodiscard]] inline std::optional<SmoothingDomains<Wedge6>> smoothing_domains<Wedge6>(
    const ElementNodes<Wedge6>& X) {
  const auto points = reference_element<internal::Wedge6OnFaces>(X);
  if (!points) return std::nullopt;
  SmoothingDomains<Wedge6> sides;
  for (std::size_t k = 0; k < sides.size(); ++k)
    sides[k] = {.dN_dX = (*points)[k].dN_dX, .volume_mm3 = (*points)[k].volume_mm3};
  return sides;
}

}  // namespace lefort::fem
