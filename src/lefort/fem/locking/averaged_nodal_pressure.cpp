#include <lefort/core/check.h>
#include <lefort/fem/deformation.h>
#include <lefort/fem/elements/all_elements.h>
#include <lefort/fem/elements/reference_element.h>
#include <lefort/fem/locking/averaged_nodal_pressure.h>
#include <lefort/fem/locking/dilatation_modes.h>
#include <lefort/fem/locking/for_each_decoupled_element.h>
#include <lefort/fem/materials/material_response.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>
#include <type_traits>

namespace lefort::fem {
namespace {

/// One node of one element. Corners with the same node and region form a patch.
struct ElementCorner {
  std::int32_t node;
  std::int32_t region;
  std::int32_t element;
  std::size_t place;         ///< In the node lists of all elements.
  double solid_angle = 0.0;  ///< At this node, in this element.
};

bool are_in_one_patch(const ElementCorner& a, const ElementCorner& b) {
  return a.node == b.node && a.region == b.region;
}

/// Location of a node in the body, outermost first.
enum class NodeLocation : std::uint8_t { kCorner, kEdge, kFace, kInterior };

/// \param solid_angle  of the elements around the node. A cube has 1/8 of the full angle at a
///   corner, 1/4 at an edge and 1/2 at a face; the thresholds are halfway. An interior node has all
///   of it, except for round-off.
NodeLocation location_of(double solid_angle) {
  const double fraction = solid_angle / (4.0 * std::numbers::pi);
  if (fraction < 0.1875) return NodeLocation::kCorner;
  if (fraction < 0.375) return NodeLocation::kEdge;
  return fraction < 0.999 ? NodeLocation::kFace : NodeLocation::kInterior;
}

/// \returns the solid angle between three edges (\cite vanoosterom1983).
double solid_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  return 2.0 * std::atan2(std::abs(a.dot(b.cross(c))),
                          la * lb * lc + a.dot(b) * lc + a.dot(c) * lb + b.dot(c) * la);
}

/// \returns the solid angle at node a, from the edges that meet there: no gap to the neighbors.
template <class Element>
double solid_angle_at(const ElementNodes<Element>& X, int a) {
  const auto to = [&](int b) -> Vec3 { return X.col(b) - X.col(a); };
  if constexpr (std::is_same_v<Element, Tet4>) {
    return solid_angle(to((a + 1) % 4), to((a + 2) % 4), to((a + 3) % 4));
  } else if constexpr (std::is_same_v<Element, Wedge6>) {
    const int first = a < 3 ? 0 : 3;
    return solid_angle(to(first + (a + 1) % 3), to(first + (a + 2) % 3), to((a + 3) % 6));
  } else {
    static_assert(std::is_same_v<Element, Pyramid5>);
    if (a < 4) return solid_angle(to((a + 1) % 4), to((a + 3) % 4), to(4));
    return solid_angle(to(0), to(1), to(2)) + solid_angle(to(0), to(2), to(3));
  }
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
class AveragedNodalPressure::Builder {
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
                                  .first_gradient = Index(term_->gradients_.size()),
                                  .first_volume = Index(term_->volumes_mm3_.size())});
    for (const ReferencePoint<Element>& point : *points) {
      term_->volumes_mm3_.push_back(point.volume_mm3);
      for (int a = 0; a < Element::kNodes; ++a) term_->gradients_.emplace_back(point.dN_dX.col(a));
    }
    first_node_.push_back(element_nodes_.size());
    for (int a = 0; a < Element::kNodes; ++a) {
      corners_.push_back(
          {nodes[a], region, element, element_nodes_.size(), solid_angle_at<Element>(X, a)});
      element_nodes_.push_back(nodes[a]);
    }
  }

  /// Call after each element of the mesh, whether or not it was added.
  void end_element() { term_->end_of_corners_.push_back(std::int32_t(element_nodes_.size())); }

  std::unique_ptr<AveragedNodalPressure> build(const RegionMaterials& materials) {
    if (corners_.empty()) return nullptr;
    std::ranges::stable_sort(corners_, [](const ElementCorner& a, const ElementCorner& b) {
      return std::tie(a.node, a.region) < std::tie(b.node, b.region);
    });
    keep_innermost_corners();
    term_->patch_of_corner_.assign(element_nodes_.size(), -1);
    for (std::size_t k = 0; k < corners_.size(); ++k) {
      const ElementCorner& corner = corners_[k];
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

  /// Removes all corners except those at the innermost nodes of each element. \pre sorted corners.
  void keep_innermost_corners() {
    std::vector<NodeLocation> locations(element_nodes_.size());
    for (auto first = corners_.begin(); first != corners_.end();) {
      const auto last = std::find_if_not(first, corners_.end(), [&](const ElementCorner& c) {
        return are_in_one_patch(*first, c);
      });
      double sum = 0.0;
      for (auto corner = first; corner != last; ++corner) sum += corner->solid_angle;
      for (; first != last; ++first) locations[first->place] = location_of(sum);
    }
    innermost_nodes_.resize(first_node_.size());
    std::vector<NodeLocation> innermost(first_node_.size());
    for (std::size_t element = 0; element < first_node_.size(); ++element) {
      const std::span of_element(locations.data() + first_node_[element],
                                 std::size_t(term_->geometries_[element].nodes));
      innermost[element] = std::ranges::max(of_element);
      innermost_nodes_[element] = double(std::ranges::count(of_element, innermost[element]));
    }
    std::erase_if(corners_, [&](const ElementCorner& corner) {
      return locations[corner.place] < innermost[std::size_t(corner.element)];
    });
  }

  void open_patch(const Material& material) {
    nodes_.open();
    term_->patches_.push_back(
        {.volume = split_volumetric(*volumetric_part(material), shear_modulus_at_rest(material),
                                    kNodalStabilizationFactor)
                       .of_mean,
         .nodes = nodes_.last(),
         .first_element = std::int32_t(term_->patch_elements_.size())});
  }

  void add_to_patch(const ElementCorner& corner) {
    NodePatch& patch = term_->patches_.back();
    const ElementGeometry& element = term_->geometries_[std::size_t(corner.element)];
    const double fraction = 1.0 / innermost_nodes_[std::size_t(corner.element)];
    term_->patch_elements_.push_back({.element = corner.element,
                                      .first_local = std::int32_t(term_->local_nodes_.size()),
                                      .fraction = fraction});
    ++patch.element_count;
    for (const std::int32_t node : nodes_of(corner.element))
      term_->local_nodes_.push_back(std::uint8_t(nodes_.add(node)));
    patch.nodes = nodes_.last();
    for (std::int32_t q = 0; q < element.points; ++q)
      patch.volume_mm3 += fraction * term_->volumes_mm3_[std::size_t(element.first_volume + q)];
    term_->patch_of_corner_[corner.place] = std::int32_t(term_->patches_.size()) - 1;
  }

  std::unique_ptr<AveragedNodalPressure> term_{new AveragedNodalPressure()};
  NodeListBuilder nodes_;
  std::vector<ElementCorner> corners_;
  std::vector<std::int32_t> element_nodes_;  ///< Of all elements.
  std::vector<std::size_t> first_node_;      ///< Of each element, in element_nodes_.
  std::vector<double> innermost_nodes_;      ///< Of each element: number of its innermost nodes.
};

std::unique_ptr<AveragedNodalPressure> AveragedNodalPressure::build(
    const mesh::VolumeMesh& mesh, const RegionMaterials& materials) {
  Builder builder;
  for_each_decoupled_element(
      mesh, materials,
      [&]<class Element>(const Element&, auto nodes, std::int32_t region) {
        if constexpr (kDilatationModes<Element> == 0)
          builder.template add_element<Element>(mesh, nodes, region);
      },
      [&] { builder.end_element(); });
  return builder.build(materials);
}

std::span<const std::int32_t> AveragedNodalPressure::nodes(Index item) const {
  const NodePatch& patch = patches_[std::size_t(item)];
  return {patch_nodes_.data() + patch.nodes.first, std::size_t(patch.nodes.count)};
}

std::span<const std::int32_t> AveragedNodalPressure::patches_of(Index number) const {
  const std::int32_t first = number == 0 ? 0 : end_of_corners_[std::size_t(number) - 1];
  return {patch_of_corner_.data() + first,
          std::size_t(end_of_corners_[std::size_t(number)] - first)};
}

template <class Function>
void AveragedNodalPressure::for_each_point(const NodePatch& patch, std::span<const Vec3> x_L,
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
      f(F, of_patch.fraction * volumes_mm3_[std::size_t(element.first_volume + q)], gradients,
        local_nodes);
    }
  }
}

std::optional<double> AveragedNodalPressure::mean_change(const NodePatch& patch,
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

bool AveragedNodalPressure::evaluate(Index item, std::span<const Vec3> x_L,
                                     LocalEquations& local) const {
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

AveragedNodalPressure::State AveragedNodalPressure::state(Index item,
                                                          std::span<const Vec3> x_L) const {
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
