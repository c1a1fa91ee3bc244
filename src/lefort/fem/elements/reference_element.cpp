#include <lefort/fem/elements/all_elements.h>
#include <lefort/fem/elements/reference_element.h>

#include <algorithm>

namespace lefort::fem {
namespace {

/// \returns the gradients at the nodes of the reference element.
template <class Element>
std::array<Eigen::Matrix<double, 3, Element::kNodes>, Element::kNodes> gradients_at_nodes() {
  std::array<Eigen::Matrix<double, 3, Element::kNodes>, Element::kNodes> gradients;
  for (int a = 0; a < Element::kNodes; ++a)
    gradients[std::size_t(a)] = Element::gradients(Element::nodes().col(a));
  return gradients;
}

}  // namespace

template <class Element>
tl::expected<ReferenceElement<Element>, ElementFault> reference_element(
    const ElementNodes<Element>& X) {
  constexpr double kMinVolume = 1e-12;  // Relative to the cube of the longest edge; round-off.
  double longest = 0.0;
  for (int a = 1; a < Element::kNodes; ++a)
    longest = std::max(longest, (X.col(a) - X.col(0)).norm());
  const double minimum = kMinVolume * longest * longest * longest;

  static const auto kQuadrature = Element::quadrature();
  static const auto kAtNodes = gradients_at_nodes<Element>();
  ReferenceElement<Element> points;
  for (std::size_t q = 0; q < points.size(); ++q) {
    const auto& dN_dxi = kQuadrature[q].dN_dxi;
    const Mat3 dX_dxi = sum_of_dyads<Element::kNodes>(X.data(), dN_dxi.data());
    const double jacobian = dX_dxi.determinant();
    if (!(jacobian > minimum)) return tl::unexpected(ElementFault{});
    multiply_columns_transposed(dX_dxi.inverse(), dN_dxi.data(), Element::kNodes,
                                points[q].dN_dX.data());
    points[q].volume_mm3 = jacobian * kQuadrature[q].weight;
  }
  for (int a = 0; a < Element::kNodes; ++a) {
    const Mat3 dX_dxi = sum_of_dyads<Element::kNodes>(X.data(), kAtNodes[std::size_t(a)].data());
    if (!(dX_dxi.determinant() > minimum)) return tl::unexpected(ElementFault{a});
  }
  return points;
}

template tl::expected<ReferenceElement<Tet4>, ElementFault> reference_element<Tet4>(
    const ElementNodes<Tet4>&);
template tl::expected<ReferenceElement<Pyramid5>, ElementFault> reference_element<Pyramid5>(
    const ElementNodes<Pyramid5>&);
template tl::expected<ReferenceElement<Wedge6>, ElementFault> reference_element<Wedge6>(
    const ElementNodes<Wedge6>&);
template tl::expected<ReferenceElement<Hex8>, ElementFault> reference_element<Hex8>(
    const ElementNodes<Hex8>&);
template tl::expected<ReferenceElement<Tet10>, ElementFault> reference_element<Tet10>(
    const ElementNodes<Tet10>&);
template tl::expected<ReferenceElement<Wedge15>, ElementFault> reference_element<Wedge15>(
    const ElementNodes<Wedge15>&);
template tl::expected<ReferenceElement<Hex20>, ElementFault> reference_element<Hex20>(
    const ElementNodes<Hex20>&);

}  // namespace lefort::fem
