/// \file
/// Smoothing domains of one element: parts of the element whose F is averaged with that of
/// neighbors (volumetric_integration.h).
#pragma once

#include <lefort/fem/elements/all_elements.h>
#include <lefort/fem/elements/reference_element.h>

#include <array>
#include <optional>

namespace lefort::fem {

/// Number of smoothing domains of a shape; 0 if its F is not averaged.
template <class Element>
inline constexpr int kSmoothingDomains = 0;
template <>
inline constexpr int kSmoothingDomains<Tet4> = 6;  ///< One at each edge.
template <>
inline constexpr int kSmoothingDomains<Wedge6> = 6;  ///< Two on each quadrilateral face.

/// Gradients and volume of each domain; the sum of the volumes is that of the element.
template <class Element>
using SmoothingDomains =
    std::array<ReferencePoint<Element>, std::size_t(kSmoothingDomains<Element>)>;

namespace internal {

/// A wedge with quadrature points on its quadrilateral faces: mid-edge points of the triangle
/// (exact to degree 2) times two Gauss points. The strain along a face is the same in both elements
/// of the face.
struct Wedge6OnFaces : Wedge6 {
  [[nodiscard]] static std::array<QuadraturePoint<kNodes>, kPoints> quadrature() {
    constexpr double kWeight = 1.0 / 6.0;
    const Rule<2, 3> middles{{{{0.5, 0.5}, kWeight}, {{0.5, 0.0}, kWeight}, {{0.0, 0.5}, kWeight}}};
    return at_points<Wedge6>(product(middles, gauss_2()));
  }
};

}  // namespace internal

/// \param X  reference positions of the nodes [mm].
/// \returns the domains, or nothing if the reference Jacobian is not positive in one of them or at
///   a node.
template <class Element>
[[nodiscard]] std::optional<SmoothingDomains<Element>> smoothing_domains(
    const ElementNodes<Element>& X);

/// One domain per edge, in the order of Tet10::kEdges.
template <>
[[nodiscard]] inline std::optional<SmoothingDomains<Tet4>> smoothing_domains<Tet4>(
    const ElementNodes<Tet4>& X) {
  const auto points = reference_element<Tet4>(X);
  if (!points) return std::nullopt;
  ReferencePoint<Tet4> domain = points->front();
  domain.volume_mm3 /= kSmoothingDomains<Tet4>;
  SmoothingDomains<Tet4> domains;
  domains.fill(domain);
  return domains;
}

/// The faces opposite to nodes 0, 1 and 2; first near the lower triangle, then near the upper.
template <>
[[nodiscard]] inline std::optional<SmoothingDomains<Wedge6>> smoothing_domains<Wedge6>(
    const ElementNodes<Wedge6>& X) {
  const auto points = reference_element<internal::Wedge6OnFaces>(X);
  if (!points) return std::nullopt;
  SmoothingDomains<Wedge6> domains;
  for (std::size_t k = 0; k < domains.size(); ++k)
    domains[k] = {.dN_dX = (*points)[k].dN_dX, .volume_mm3 = (*points)[k].volume_mm3};
  return domains;
}

}  // namespace lefort::fem
