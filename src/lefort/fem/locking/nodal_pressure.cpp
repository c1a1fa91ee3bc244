#include <lefort/core/check.h>
#include <lefort/fem/deformation.h>
#include <lefort/fem/elements/corner_shape.h>
#include <lefort/fem/elements/reference_element.h>
#include <lefort/fem/locking/for_each_decoupled_element.h>
#include <lefort/fem/locking/lone_corners.h>
#include <lefort/fem/locking/nodal_pressure.h>
#include <lefort/fem/locking/volumetric_integration.h>
#include <lefort/fem/locking/volumetric_split.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <numeric>
#include <tuple>

namespace lefort::fem {
namespace {

/// One node of one element. Corners with the same node and region form a patch.
struct ElementCorner {
  std::int32_t node;
  std::int32_t region;
  std::int32_t element;
  std::size_t place;    ///< In the corner lists of all elements.
  std::int32_t corner;  ///< In the element.
};

bool are_in_one_patch(const ElementCorner& a, const ElementCorner& b) {
  return a.node == b.node && a.region == b.region;
}

/// Adds factor * d2J/dx2: a displacement v of node b changes dJ/dx_a by v x (F (g_a x g_b)).
void add_geometric_stiffness(double factor, const Mat3& F, std::span<const Vec3> gradients,
                             std::span<const std::uint8_t> local_nodes, LocalEquations& local) {
  for (std::size_t a = 0; a < local_nodes.size(); ++a)
    for (std::size_t b = 0; b < local_nodes.size(); ++b) {
      const Vec3 w = factor * (F * gradients[a].cross(gradients[b]));
      Mat3 cross;  // v -> v x w.
      cross << 0.0, w.z(), -w.y(), -w.z(), 0.0, w.x(), w.y(), -w.x(), 0.0;
      local.stiffness_n_per_mm.block<3, 3>(3 * Index(local_nodes[a]), 3 * Index(local_nodes[b])) +=
          cross;
    }
}

}  // namespace

/// Collects the elements, then sorts their corners into patches.
class NodalPressure::Builder {
 public:
  /// \param nodes  of the element.
  template <class Element>
  void add_element(const mesh::VolumeMesh& mesh, const std::int32_t* nodes, std::int32_t region) {
    ElementNodes<Element> X;
    for (int a = 0; a < Element::kNodes; ++a) X.col(a) = mesh.nodes_L[std::size_t(nodes[a])];
    const auto points = reference_element<Element>(X);
    LEFORT_CHECK(points.has_value());
    const auto element = std::int32_t(term_->geometries_.size());
    term_->geometries_.push_back({.points = Element::kPoints,
                                  .nodes = Element::kNodes,
                                  .corners = CornerShape<Element>::kNodes,
                                  .first_gradient = Index(term_->gradients_.size()),
                                  .first_weight = Index(term_->weights_mm3_.size())});
    static const auto kQuadrature = Element::quadrature();
    for (std::size_t q = 0; q < points->size(); ++q) {
      const ReferencePoint<Element>& point = (*points)[q];
      for (const double N : corner_functions<Element>(kQuadrature[q].N))
        term_->weights_mm3_.push_back(N * point.volume_mm3);
      for (int a = 0; a < Element::kNodes; ++a) term_->gradients_.emplace_back(point.dN_dX.col(a));
    }
    first_node_.push_back(element_nodes_.size());
    shares_lone_corners_.push_back(kSharesLoneCorners<Element>);
    element_nodes_.insert(element_nodes_.end(), nodes, nodes + Element::kNodes);
    for (int a = 0; a < CornerShape<Element>::kNodes; ++a)
      corners_.push_back({nodes[a], region, element, corner_count_++, a});
  }

  /// Call after each element of the mesh, whether or not it was added.
  void end_element() { term_->end_of_corners_.push_back(std::int32_t(corner_count_)); }

  std::unique_ptr<NodalPressure> build(const RegionMaterials& materials) {
    if (corners_.empty()) return nullptr;
    std::ranges::stable_sort(corners_, [](const ElementCorner& a, const ElementCorner& b) {
      return std::tie(a.node, a.region) < std::tie(b.node, b.region);
    });
    term_->patch_of_corner_.assign(corner_count_, -1);
    term_->fraction_of_corner_.assign(corner_count_, 0.0);
    share_lone_corners();
    for (std::size_t k = 0; k < corners_.size(); ++k) {
      const ElementCorner& corner = corners_[k];
      if (corner_volume_mm3(corner) == 0.0) continue;  // Without a pressure of its own.
      if (k == 0 || !are_in_one_patch(corners_[k - 1], corner) ||
          !nodes_.has_room_for(nodes_of(corner.element)))
        open_patch(materials.at(corner.region));
      add_to_patch(corner);
    }
    term_->patch_nodes_ = nodes_.take();
    return std::move(term_);
  }

 private:
  [[nodiscard]] std::span<const std::int32_t> nodes_of(std::int32_t element) const {
    return {element_nodes_.data() + first_node_[std::size_t(element)],
            std::size_t(term_->geometries_[std::size_t(element)].nodes)};
  }

  /// \returns the integral of the pressure function of this corner over its element.
  [[nodiscard]] double corner_volume_mm3(const ElementCorner& corner) const {
    const ElementGeometry& element = term_->geometries_[std::size_t(corner.element)];
    double sum_mm3 = 0.0;
    for (std::int32_t q = 0; q < element.points; ++q)
      sum_mm3 += term_->weight_mm3(element, q, corner.corner);
    return sum_mm3;
  }

  /// Replaces the functions of elements with lone corners. Needs the sorted corners.
  void share_lone_corners() {
    std::map<std::int32_t, LoneCorners> lone_of_element;
    for (std::size_t k = 0; k < corners_.size(); ++k) {
      const ElementCorner& corner = corners_[k];
      const bool is_lone = (k == 0 || !are_in_one_patch(corners_[k - 1], corner)) &&
                           (k + 1 == corners_.size() || !are_in_one_patch(corner, corners_[k + 1]));
      if (is_lone && shares_lone_corners_[std::size_t(corner.element)])
        lone_of_element.try_emplace(corner.element).first->second[std::size_t(corner.corner)] =
            true;
    }
    for (const auto& [number, is_lone] : lone_of_element) {
      const ElementGeometry& element = term_->geometries_[std::size_t(number)];
      const Eigen::Matrix<double, 8, 8> T = pressure_functions(is_lone);
      for (std::int32_t q = 0; q < element.points; ++q) {
        Eigen::Map<Eigen::Matrix<double, 8, 1>> weights(
            &term_->weights_mm3_[std::size_t(element.first_weight + Index(q) * element.corners)]);
        weights = (T * weights).eval();
      }
    }
  }

  void open_patch(const Material& material) {
    nodes_.open();
    term_->patches_.push_back({.volume = volumetric_of_pressure(material),
                               .nodes = nodes_.last(),
                               .first_element = std::int32_t(term_->patch_elements_.size())});
  }

  void add_to_patch(const ElementCorner& corner) {
    NodePatch& patch = term_->patches_.back();
    const ElementGeometry& element = term_->geometries_[std::size_t(corner.element)];
    term_->patch_elements_.push_back({.element = corner.element,
                                      .first_local = std::int32_t(term_->local_nodes_.size()),
                                      .corner = corner.corner});
    ++patch.element_count;
    for (const std::int32_t node : nodes_of(corner.element))
      term_->local_nodes_.push_back(std::uint8_t(nodes_.add(node)));
    patch.nodes = nodes_.last();
    const double volume_mm3 = corner_volume_mm3(corner);
    patch.volume_mm3 += volume_mm3;
    term_->patch_of_corner_[corner.place] = std::int32_t(term_->patches_.size()) - 1;
    term_->fraction_of_corner_[corner.place] = volume_mm3 / element_volume_mm3(element);
  }

  [[nodiscard]] double element_volume_mm3(const ElementGeometry& element) const {
    const auto weights = std::span(term_->weights_mm3_)
                             .subspan(std::size_t(element.first_weight),
                                      std::size_t(element.points * element.corners));
    return std::accumulate(weights.begin(), weights.end(), 0.0);
  }

  std::unique_ptr<NodalPressure> term_{new NodalPressure()};
  NodeListBuilder nodes_;
  std::vector<ElementCorner> corners_;
  std::vector<std::int32_t> element_nodes_;  ///< Of all elements.
  std::vector<std::size_t> first_node_;      ///< Of each element, in element_nodes_.
  std::vector<bool> shares_lone_corners_;    ///< Of each element (lone_corners.h).
  std::size_t corner_count_ = 0;             ///< Of all elements.
};

std::unique_ptr<NodalPressure> NodalPressure::build(const mesh::VolumeMesh& mesh,
                                                    const RegionMaterials& materials) {
  Builder builder;
  for_each_decoupled_element(
      mesh, materials,
      [&]<class Element>(const Element&, auto nodes, std::int32_t region) {
        if constexpr (kVolumeAverage<Element> == VolumeAverage::kCornerNodes)
          builder.template add_element<Element>(mesh, nodes, region);
      },
      [&] { builder.end_element(); });
  return builder.build(materials);
}

std::span<const std::int32_t> NodalPressure::nodes(Index item) const {
  const NodePatch& patch = patches_[std::size_t(item)];
  return {patch_nodes_.data() + patch.nodes.first, std::size_t(patch.nodes.count)};
}

NodalPressure::State NodalPressure::mean_of(Index number, std::span<const State> of_items) const {
  State mean;
  const auto first = std::size_t(number == 0 ? 0 : end_of_corners_[std::size_t(number) - 1]);
  for (std::size_t place = first; place < std::size_t(end_of_corners_[std::size_t(number)]);
       ++place) {
    if (patch_of_corner_[place] < 0) continue;
    const State& state = of_items[std::size_t(patch_of_corner_[place])];
    mean.pressure_mpa += fraction_of_corner_[place] * state.pressure_mpa;
    mean.energy_density_mpa += fraction_of_corner_[place] * state.energy_density_mpa;
  }
  return mean;
}

template <class Function>
void NodalPressure::for_each_point(const NodePatch& patch, std::span<const Vec3> x_L,
                                   const Function& f) const {
  for (std::int32_t m = patch.first_element; m < patch.first_element + patch.element_count; ++m) {
    const PatchElement& of_patch = patch_elements_[std::size_t(m)];
    const ElementGeometry& element = geometries_[std::size_t(of_patch.element)];
    const std::span local_nodes(local_nodes_.data() + of_patch.first_local,
                                std::size_t(element.nodes));
    for (std::int32_t q = 0; q < element.points; ++q) {
      const Index first = element.first_gradient + Index(q) * element.nodes;
      const std::span gradients(gradients_.data() + first, std::size_t(element.nodes));
      Mat3 F = Mat3::Zero();
      for (std::size_t a = 0; a < gradients.size(); ++a)
        F.noalias() += x_L[local_nodes[a]] * gradients[a].transpose();
      f(F, weight_mm3(element, q, of_patch.corner), gradients, local_nodes);
    }
  }
}

std::optional<double> NodalPressure::mean_change(const NodePatch& patch,
                                                 std::span<const Vec3> x_L) const {
  double sum_mm3 = 0.0;
  bool is_admissible = true;
  for_each_point(patch, x_L, [&](const Mat3& F, double weight_mm3, auto, auto) {
    const double change = jacobian_minus_one(F);
    is_admissible = is_admissible && change > -1.0;
    sum_mm3 += weight_mm3 * change;
  });
  const double mean = sum_mm3 / patch.volume_mm3;
  if (!is_admissible || !(mean > -1.0)) return std::nullopt;
  return mean;
}

bool NodalPressure::evaluate(Index item, std::span<const Vec3> x_L, LocalEquations& local) const {
  const NodePatch& patch = patches_[std::size_t(item)];
  const std::optional<double> change = mean_change(patch, x_L);
  if (!change) return false;
  const double pressure = patch.volume.dU_dJ(1.0 + *change);
  local.energy_mj = patch.volume_mm3 * patch.volume.energy_minus_one(*change);

  Eigen::Map<VectorX>& dv = local.residual_n;  // dv/dx; multiplied by p at the end.
  for_each_point(
      patch, x_L, [&](const Mat3& F, double weight_mm3, auto gradients, auto local_nodes) {
        const Mat3 dJ_dF = weight_mm3 * cofactor(F);
        for (std::size_t a = 0; a < local_nodes.size(); ++a)
          dv.segment<3>(3 * Index(local_nodes[a])) += dJ_dF * gradients[a];
        if (local.wants_stiffness() && local.tangent == Tangent::kExact)
          add_geometric_stiffness(pressure * weight_mm3, F, gradients, local_nodes, local);
      });
  if (local.wants_stiffness()) {
    const double per_volume = patch.volume.d2U_dJ2(1.0 + *change) / patch.volume_mm3;
    for (Index j = 0; j < dv.size(); ++j)
      local.stiffness_n_per_mm.col(j) += (per_volume * dv[j]) * dv;
  }
  dv *= pressure;
  return true;
}

NodalPressure::State NodalPressure::state(Index item, std::span<const Vec3> x_L) const {
  const NodePatch& patch = patches_[std::size_t(item)];
  std::array<Vec3, kMaxLocalNodes> local_x_L;
  const std::span<const std::int32_t> nodes_of_patch = nodes(item);
  for (std::size_t a = 0; a < nodes_of_patch.size(); ++a)
    local_x_L[a] = x_L[std::size_t(nodes_of_patch[a])];
  const std::optional<double> change =
      mean_change(patch, {local_x_L.data(), nodes_of_patch.size()});
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  if (!change) return {kNan, kNan};
  return {patch.volume.dU_dJ(1.0 + *change), patch.volume.energy_minus_one(*change)};
}

}  // namespace lefort::fem
