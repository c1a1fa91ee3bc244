/// \file
/// Strain energy of elements of one shape, with averaged volume change in decoupled laws.
#pragma once

#include <lefort/fem/assembly/element_energy.h>
#include <lefort/fem/locking/volumetric_integration.h>

#include <array>
#include <span>
#include <utility>

namespace lefort::fem {

/// Mean dilatation method, one mean per element (\cite simo1985; \cite bonet2008, section 8.6.5):
///
///   W       = sum over elements of (sum over points of Psi_iso(F) dV + U(J_mean) V)
///   J_mean  = sum over points of J dV / V
///   dW      = sum of (dPsi_iso/dF + p cof F) : dF dV,   p = U'(J_mean)
///
/// Elements whose law is not decoupled are evaluated as in ContinuumTerm.
template <class Element>
class MeanDilatationTerm final : public ForceTerm {
 public:
  explicit MeanDilatationTerm(ElementData<Element> data) : data_(std::move(data)) {}

  [[nodiscard]] Index item_count() const override { return data_.count(); }
  [[nodiscard]] std::span<const std::int32_t> nodes(Index item) const override {
    return data_.nodes_of(item);
  }

  [[nodiscard]] bool evaluate(Index item, std::span<const Vec3> x_L,
                              LocalEquations& local) const override {
    const Material& material = data_.material_of(item);
    const Eigen::Map<const ElementNodes<Element>> x(x_L.data()->data());
    const ReferenceElement<Element>& points = data_.points[std::size_t(item)];
    const Volumetric* volume = volumetric_part(material);
    if (volume == nullptr)
      return add_strain_energy<Element>(material, LawPart::kWhole, points, x, local);
    if (!add_strain_energy<Element>(material, LawPart::kIsochoric, points, x, local)) return false;
    return add_volume(*volume, points, x, local);
  }

 private:
  static bool add_volume(const Volumetric& volume, const ReferenceElement<Element>& points,
                         const Eigen::Map<const ElementNodes<Element>>& x, LocalEquations& local) {
    constexpr int kSize = 3 * Element::kNodes;
    std::array<Mat3, Element::kPoints> F;
    double volume_mm3 = 0.0;
    double growth_mm3 = 0.0;
    for (std::size_t q = 0; q < F.size(); ++q) {
      F[q] = deformation_gradient<Element>(x, points[q]);
      volume_mm3 += points[q].volume_mm3;
      growth_mm3 += points[q].volume_mm3 * jacobian_minus_one(F[q]);
    }
    const double change = growth_mm3 / volume_mm3;
    if (!(change > -1.0)) return false;
    local.energy_mj += volume_mm3 * volume.energy_minus_one(change);
    const double pressure = volume.dU_dJ(1.0 + change);

    ElementNodes<Element> dv = ElementNodes<Element>::Zero();  // Of the current volume.
    double* K = local.stiffness_n_per_mm.data();
    for (std::size_t q = 0; q < F.size(); ++q) {
      const double dV = points[q].volume_mm3;
      const double* dN_dX = points[q].dN_dX.data();
      ElementNodes<Element> dJ;
      multiply_columns(cofactor(F[q]), dN_dX, Element::kNodes, dJ.data());
      dv += dV * dJ;
      if (local.wants_stiffness() && local.tangent == Tangent::kExact)
        add_point_stiffness(pressure * cofactor_tangent(F[q]), dV, dN_dX, Element::kNodes, K);
    }
    Eigen::Map<ElementNodes<Element>>(local.residual_n.data()) += pressure * dv;
    if (local.wants_stiffness()) {
      const ElementNodes<Element> scaled = volume.d2U_dJ2(1.0 + change) / volume_mm3 * dv;
      add_low_rank_product(scaled.data(), dv.data(), kSize, 1, K);
    }
    return true;
  }

  ElementData<Element> data_;
};

}  // namespace lefort::fem
