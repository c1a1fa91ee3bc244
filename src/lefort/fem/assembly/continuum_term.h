/// \file
/// Strain energy of elements of one shape at their quadrature points (volumetric_integration.h).
#pragma once

#include <lefort/fem/assembly/element_energy.h>

#include <span>
#include <utility>

namespace lefort::fem {

/// W = sum over elements and points of c Psi(F) dV. For decoupled laws c < 1 if a
/// SmoothedStrainTerm has the fraction 1 - c; otherwise c = 1. Psi lacks the volumetric part that
/// AveragedNodalPressure has.
template <class Element>
class ContinuumTerm final : public ForceTerm {
 public:
  /// \param data      the elements.
  /// \param fraction  c of decoupled laws.
  ContinuumTerm(ElementData<Element> data, double fraction)
      : data_(std::move(data)), fraction_(fraction) {}

  [[nodiscard]] Index item_count() const override { return data_.count(); }

  [[nodiscard]] std::span<const std::int32_t> nodes(Index item) const override {
    return data_.nodes_of(item);
  }

  [[nodiscard]] bool evaluate(Index item, std::span<const Vec3> x_L,
                              LocalEquations& local) const override {
    const Eigen::Map<const ElementNodes<Element>> x(x_L.data()->data());
    const Material& material = data_.material_of(item);
    const double fraction = volumetric_part(material) == nullptr ? 1.0 : fraction_;
    return add_strain_energy<Element>(material, LawPart::kWhole, fraction,
                                      data_.points[std::size_t(item)], x, local);
  }

 private:
  ElementData<Element> data_;
  double fraction_;
};

}  // namespace lefort::fem
