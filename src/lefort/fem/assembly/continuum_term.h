/// \file
/// Strain energy of elements of one shape with full integration (element_term.h).
#pragma once

#include <lefort/fem/assembly/element_energy.h>

#include <span>
#include <utility>

namespace lefort::fem {

/// W = sum over elements and points of Psi(F) dV.
template <class Element>
class ContinuumTerm final : public ForceTerm {
 public:
  explicit ContinuumTerm(ElementData<Element> data) : data_(std::move(data)) {}

  [[nodiscard]] Index item_count() const override { return data_.count(); }

  [[nodiscard]] std::span<const std::int32_t> nodes(Index item) const override {
    return data_.nodes_of(item);
  }

  [[nodiscard]] bool evaluate(Index item, std::span<const Vec3> x_L,
                              LocalEquations& local) const override {
    const Eigen::Map<const ElementNodes<Element>> x(x_L.data()->data());
    return add_strain_energy<Element>(data_.material_of(item), LawPart::kWhole,
                                      data_.points[std::size_t(item)], x, local);
  }

 private:
  ElementData<Element> data_;
};

}  // namespace lefort::fem
