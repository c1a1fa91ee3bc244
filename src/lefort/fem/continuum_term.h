/// \file
/// The strain energy of elements of one shape: the kernel behind element_term.h.
#pragma once

#include <lefort/fem/element_energy.h>

#include <span>
#include <utility>

namespace lefort::fem {

/// W = sum over elements and points of Psi(F) dV.
template <class Element>
class ContinuumTerm final : public ForceTerm {
 public:
  /// \param part   of laws in split form what makes up Psi.
  /// \param share  what that is multiplied by.
  ContinuumTerm(ElementData<Element> data, LawPart part, double share)
      : data_(std::move(data)), part_(part), share_(share) {}

  [[nodiscard]] Index item_count() const override { return data_.count(); }

  [[nodiscard]] std::span<const std::int32_t> nodes(Index item) const override {
    return data_.nodes_of(item);
  }

  [[nodiscard]] bool evaluate(Index item, std::span<const Vec3> x_L,
                              LocalEquations& local) const override {
    const Eigen::Map<const ElementNodes<Element>> x(x_L.data()->data());
    const Material& material = data_.material_of(item);
    const double share = volumetric_part(material) == nullptr ? 1.0 : share_;
    return add_strain_energy<Element>(material, part_, share, data_.points[std::size_t(item)], x,
                                      local);
  }

 private:
  ElementData<Element> data_;
  LawPart part_;
  double share_;
};

}  // namespace lefort::fem
