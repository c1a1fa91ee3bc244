/// \file
/// The strain energy of elements of one shape: the kernel behind element_term.h.
#pragma once

#include <lefort/fem/deformation.h>
#include <lefort/fem/force_term.h>
#include <lefort/fem/material.h>
#include <lefort/fem/reference_element.h>

#include <utility>
#include <vector>

namespace lefort::fem {

/// W = sum over elements and points of Psi(F) dV.
template <class Element>
class ContinuumTerm final : public ForceTerm {
 public:
  /// \param nodes      Element::kNodes per element.
  /// \param points     one per element.
  /// \param materials  the laws that occur.
  /// \param material   for each element, its place in `materials`.
  ContinuumTerm(std::vector<std::int32_t> nodes, std::vector<ReferenceElement<Element>> points,
                std::vector<Material> materials, std::vector<std::int32_t> material)
      : nodes_(std::move(nodes)),
        points_(std::move(points)),
        materials_(std::move(materials)),
        material_(std::move(material)) {}

  [[nodiscard]] Index item_count() const override { return Index(points_.size()); }

  [[nodiscard]] std::span<const std::int32_t> nodes(Index item) const override {
    return {nodes_.data() + item * Element::kNodes, std::size_t(Element::kNodes)};
  }

  [[nodiscard]] bool evaluate(Index item, std::span<const Vec3> x_L,
                              LocalEquations& local) const override {
    const Material& material = materials_[std::size_t(material_[std::size_t(item)])];
    return std::visit([&](const auto& law) { return add(law, item, x_L, local); }, material);
  }

 private:
  template <class Law>
  bool add(const Law& law, Index item, std::span<const Vec3> x_L, LocalEquations& local) const {
    const Eigen::Map<const ElementNodes<Element>> x(x_L.data()->data());
    Eigen::Map<ElementNodes<Element>> residual(local.residual_n.data());
    for (const ReferencePoint<Element>& point : points_[std::size_t(item)]) {
      const Mat3 F = deformation_gradient<Element>(x, point);
      if (!(volume_ratio(F) > 0.0)) return false;  // Also if NaN.
      const Mat3 P = law.stress(F);
      local.energy_mj += point.volume_mm3 * law.energy(F);
      residual.noalias() += point.volume_mm3 * P * point.dN_dX;
      if (local.wants_stiffness()) add_stiffness(law.tangent(F), point, local);
    }
    return true;
  }

  /// K_ab += dN_a/dX . (dP/dF) . dN_b/dX dV, the second index of P and of F contracted.
  /// Not copied into each law's evaluation: it is long, and the same for all.
  [[gnu::noinline]] static void add_stiffness(const Mat9& A, const ReferencePoint<Element>& point,
                                              LocalEquations& local) {
    constexpr int kSize = 3 * Element::kNodes;
    Eigen::Map<Eigen::Matrix<double, kSize, kSize>> K(local.stiffness_n_per_mm.data());
    for (int b = 0; b < Element::kNodes; ++b) {
      const Vec3 g_b = point.volume_mm3 * point.dN_dX.col(b);
      const Eigen::Matrix<double, 9, 3> dP =
          g_b[0] * A.leftCols<3>() + g_b[1] * A.middleCols<3>(3) + g_b[2] * A.rightCols<3>();
      for (int a = b; a < Element::kNodes; ++a) {
        const Vec3 g_a = point.dN_dX.col(a);
        const Mat3 K_ab =
            g_a[0] * dP.topRows<3>() + g_a[1] * dP.middleRows<3>(3) + g_a[2] * dP.bottomRows<3>();
        K.template block<3, 3>(3 * a, 3 * b) += K_ab;
        if (a != b) K.template block<3, 3>(3 * b, 3 * a) += K_ab.transpose();
      }
    }
  }

  std::vector<std::int32_t> nodes_;
  std::vector<ReferenceElement<Element>> points_;
  std::vector<Material> materials_;
  std::vector<std::int32_t> material_;
};

}  // namespace lefort::fem
