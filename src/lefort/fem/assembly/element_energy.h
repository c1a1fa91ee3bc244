/// \file
/// Elements of one shape with their laws, and the strain energy of one element.
#pragma once

#include <lefort/fem/assembly/force_term.h>
#include <lefort/fem/deformation.h>
#include <lefort/fem/elements/reference_element.h>
#include <lefort/fem/materials/material_response.h>

#include <cstdint>
#include <span>
#include <vector>

namespace lefort::fem {

/// Elements of one shape.
template <class Element>
struct ElementData {
  std::vector<std::int32_t> nodes;                ///< Element::kNodes per element.
  std::vector<ReferenceElement<Element>> points;  ///< One per element.
  std::vector<Material> materials;                ///< Each law once.
  std::vector<std::int32_t> material;             ///< Of each element, an index into `materials`.

  [[nodiscard]] Index count() const { return Index(points.size()); }
  [[nodiscard]] std::span<const std::int32_t> nodes_of(Index element) const {
    return {nodes.data() + element * Element::kNodes, std::size_t(Element::kNodes)};
  }
  [[nodiscard]] const Material& material_of(Index element) const {
    return materials[std::size_t(material[std::size_t(element)])];
  }
};

/// Adds the energy, the sum over points of Psi(F) dV, its forces and stiffness.
/// \param material  the law.
/// \param part      Psi: the whole law or its isochoric part.
/// \param points    reference element.
/// \param x         current positions of the nodes [mm].
/// \param local     receives energy, forces and stiffness.
/// \returns false if J <= 0 at a point, or NaN.
template <class Element>
bool add_strain_energy(const Material& material, LawPart part,
                       const ReferenceElement<Element>& points,
                       const Eigen::Map<const ElementNodes<Element>>& x, LocalEquations& local) {
  Eigen::Map<ElementNodes<Element>> residual(local.residual_n.data());
  for (const ReferencePoint<Element>& point : points) {
    const Mat3 F = deformation_gradient<Element>(x, point);
    if (!(volume_ratio(F) > 0.0)) return false;  // Also if NaN.
    const Mat3 P = stress(material, part, F);
    const double dV = point.volume_mm3;
    local.energy_mj += dV * energy(material, part, F);
    ElementNodes<Element> forces;
    multiply_columns(dV * P, point.dN_dX.data(), Element::kNodes, forces.data());
    residual += forces;
    if (local.wants_stiffness())
      add_point_stiffness(tangent(material, part, F), dV, point.dN_dX.data(), Element::kNodes,
                          local.stiffness_n_per_mm.data());
  }
  return true;
}

}  // namespace lefort::fem
