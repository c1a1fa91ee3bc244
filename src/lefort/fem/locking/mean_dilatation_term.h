/// \file
/// Strain energy of elements of one shape, with averaged volume change in decoupled laws.
#pragma once

#include <lefort/fem/assembly/element_energy.h>
#include <lefort/fem/locking/dilatation_modes.h>

#include <array>
#include <span>
#include <utility>
#include <vector>

namespace lefort::fem {

/// Mean dilatation method (\cite simo1985; \cite bonet2008, section 8.6.5):
///
///   W       = sum over elements and points of (Psi_iso(F) + U(J_mean)) dV
///   J_mean  = sum over i of psi_i theta_i,   theta_i = sum over points of psi_i J dV
///   dW      = sum of (dPsi_iso/dF + p cof F) : dF dV
///   p       = sum over i of psi_i p_i,       p_i = sum over points of psi_i U'(J_mean) dV
///
/// A part of U stays at the points if the shape needs this (VolumetricSplit). Elements whose law is
/// not decoupled are evaluated as in ContinuumTerm.
template <class Element>
class MeanDilatationTerm final : public ForceTerm {
 public:
  /// \param data              the elements.
  /// \param modes             one per element.
  /// \param is_in_thick_part  elements_in_thick_parts() of these elements; may be empty if
  ///   the shape does not need it.
  MeanDilatationTerm(ElementData<Element> data, std::vector<DilatationModes<Element>> modes,
                     std::span<const char> is_in_thick_part)
      : data_(std::move(data)), modes_(std::move(modes)) {
    volumes_.reserve(modes_.size());
    for (Index e = 0; e < data_.count(); ++e)
      volumes_.push_back(split_volumetric<Element>(
          data_.material_of(e),
          !is_in_thick_part.empty() && is_in_thick_part[std::size_t(e)] != 0));
  }

  [[nodiscard]] Index item_count() const override { return data_.count(); }
  [[nodiscard]] std::span<const std::int32_t> nodes(Index item) const override {
    return data_.nodes_of(item);
  }

  [[nodiscard]] bool evaluate(Index item, std::span<const Vec3> x_L,
                              LocalEquations& local) const override {
    const Material& material = data_.material_of(item);
    const Eigen::Map<const ElementNodes<Element>> x(x_L.data()->data());
    const ReferenceElement<Element>& points = data_.points[std::size_t(item)];
    if (volumetric_part(material) == nullptr)
      return add_strain_energy<Element>(material, LawPart::kWhole, 1.0, points, x, local);
    if (!add_strain_energy<Element>(material, LawPart::kIsochoric, 1.0, points, x, local))
      return false;
    return add_volume(volumes_[std::size_t(item)], points, modes_[std::size_t(item)], x, local);
  }

 private:
  static bool add_volume(const VolumetricSplit& volume, const ReferenceElement<Element>& points,
                         const DilatationModes<Element>& modes,
                         const Eigen::Map<const ElementNodes<Element>>& x, LocalEquations& local) {
    constexpr int kSize = 3 * Element::kNodes;
    constexpr int kModes = kDilatationModes<Element>;
    std::array<Mat3, Element::kPoints> F;
    Eigen::Matrix<double, Element::kPoints, 1> change;
    for (std::size_t q = 0; q < F.size(); ++q) {
      F[q] = deformation_gradient<Element>(x, points[q]);
      change[Index(q)] = jacobian_minus_one(F[q]);
    }
    const auto response = volume_response<Element>(volume, points, modes, change);
    if (!response) return false;
    local.energy_mj += response->energy_mj;

    Eigen::Map<ElementNodes<Element>> residual(local.residual_n.data());
    // Column i is dtheta_i/dx.
    Eigen::Matrix<double, kSize, kModes> dtheta = Eigen::Matrix<double, kSize, kModes>::Zero();
    double* K = local.stiffness_n_per_mm.data();
    for (std::size_t q = 0; q < F.size(); ++q) {
      const double dV = points[q].volume_mm3;
      const double* dN_dX = points[q].dN_dX.data();
      ElementNodes<Element> dJ;
      multiply_columns(cofactor(F[q]), dN_dX, Element::kNodes, dJ.data());
      residual += dV * response->pressure[Index(q)] * dJ;
      if (!local.wants_stiffness()) continue;
      if (local.tangent == Tangent::kExact)
        add_point_stiffness(response->pressure[Index(q)] * cofactor_tangent(F[q]), dV, dN_dX,
                            Element::kNodes, K);
      for (int i = 0; i < kModes; ++i) dtheta.col(i) += dV * dJ.reshaped() * modes(Index(q), i);
      if constexpr (kHasPointwiseBulk<Element>) {
        const ElementNodes<Element> scaled = dV * response->curvature_at_points[Index(q)] * dJ;
        add_low_rank_product(scaled.data(), dJ.data(), kSize, 1, K);
      }
    }
    if (local.wants_stiffness()) {
      Eigen::Matrix<double, kSize, kModes> scaled = Eigen::Matrix<double, kSize, kModes>::Zero();
      for (int j = 0; j < kModes; ++j)
        for (int i = 0; i < kModes; ++i) scaled.col(j) += dtheta.col(i) * response->curvature(i, j);
      add_low_rank_product(scaled.data(), dtheta.data(), kSize, kModes, K);
    }
    return true;
  }

  ElementData<Element> data_;
  std::vector<VolumetricSplit> volumes_;  ///< One per element.
  std::vector<DilatationModes<Element>> modes_;
};

}  // namespace lefort::fem
