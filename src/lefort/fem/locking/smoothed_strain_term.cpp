#include <lefort/core/check.h>
#include <lefort/fem/deformation.h>
#include <lefort/fem/elements/all_elements.h>
#include <lefort/fem/locking/dilatation_modes.h>
#include <lefort/fem/locking/for_each_decoupled_element.h>
#include <lefort/fem/locking/smoothed_strain_term.h>
#include <lefort/fem/locking/smoothing_domains.h>
#include <lefort/fem/materials/material_response.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

namespace lefort::fem {
namespace {

/// One side of one element.
struct Side {
  std::array<std::int32_t, 4> shared;  ///< Nodes that it has in common with its neighbors'.
  std::int32_t region;
  std::int32_t part;   ///< Which element, of those that take part.
  std::int32_t place;  ///< In the list of all sides.
  Index first_gradient;
  double volume_mm3;
};

bool belong_together(const Side& a, const Side& b) {
  return a.shared == b.shared && a.region == b.region;
}

/// The nodes of one element.
using Part = std::span<const std::int32_t>;

std::pair<std::int32_t, std::int32_t> ascending(std::int32_t a, std::int32_t b) {
  return {std::min(a, b), std::max(a, b)};
}

/// What the sides of one element share: the ends of its edge k.
std::array<std::int32_t, 4> shared_nodes(const Tet4&, const std::int32_t* nodes, std::size_t k) {
  const auto [i, j] = Tet10::kEdges[k];
  const auto [low, high] = ascending(nodes[i], nodes[j]);
  return {low, high, -1, -1};
}

/// The corners of its upright face k % 3, those of the nearer triangle first.
std::array<std::int32_t, 4> shared_nodes(const Wedge6&, const std::int32_t* nodes, std::size_t k) {
  constexpr std::array<std::pair<int, int>, 3> kEdges{{{1, 2}, {2, 0}, {0, 1}}};
  const auto [i, j] = kEdges[k % 3];
  const auto [low, high] = ascending(nodes[i], nodes[j]);
  const auto [upper_low, upper_high] = ascending(nodes[i + 3], nodes[j + 3]);
  if (k < 3) return {low, high, upper_low, upper_high};
  return {upper_low, upper_high, low, high};
}

}  // namespace

/// Collects elements, then sorts their sides into groups.
class SmoothedStrainTerm::Builder {
 public:
  template <class Element>
  void add_element(const mesh::VolumeMesh& mesh, const std::int32_t* nodes, std::int32_t region) {
    ElementNodes<Element> X;
    for (int a = 0; a < Element::kNodes; ++a) X.col(a) = mesh.nodes_L[std::size_t(nodes[a])];
    const auto sides = smoothing_domains<Element>(X);
    LEFORT_CHECK(sides.has_value());
    double volume_mm3 = 0.0;
    for (const auto& side : *sides) volume_mm3 += side.volume_mm3;
    for (std::size_t k = 0; k < sides->size(); ++k) {
      const auto& side = (*sides)[k];
      domains_.push_back({.shared = shared_nodes(Element{}, nodes, k),
                          .region = region,
                          .part = std::int32_t(parts_.size()),
                          .place = std::int32_t(domains_.size()),
                          .first_gradient = Index(side_gradients_.size()),
                          .volume_mm3 = side.volume_mm3});
      for (int a = 0; a < Element::kNodes; ++a) side_gradients_.emplace_back(side.dN_dX.col(a));
      term_->domains_.push_back({.fraction = side.volume_mm3 / volume_mm3});
    }
    parts_.emplace_back(nodes, std::size_t(Element::kNodes));
  }

  /// To be called after each element of the mesh, whether or not it was added.
  void end_element() { term_->end_of_domains_.push_back(std::int32_t(domains_.size())); }

  std::unique_ptr<SmoothedStrainTerm> build(const RegionMaterials& materials) {
    if (domains_.empty()) return nullptr;
    std::ranges::sort(domains_, [](const Side& a, const Side& b) {
      return std::tie(a.shared, a.region, a.part) < std::tie(b.shared, b.region, b.part);
    });
    std::map<std::int32_t, std::int32_t> place_of_region;
    for (std::size_t k = 0; k < domains_.size(); ++k) {
      const Side& side = domains_[k];
      if (k == 0 || !belong_together(domains_[k - 1], side) ||
          !nodes_.has_room_for(parts_[std::size_t(side.part)])) {
        const auto [place, is_new] =
            place_of_region.try_emplace(side.region, std::int32_t(term_->materials_.size()));
        if (is_new)
          term_->materials_.push_back(element_law_without_nodal_part(materials.at(side.region)));
        nodes_.open();
        term_->groups_.push_back({.nodes = nodes_.last(), .material = place->second});
      }
      add_side(side);
    }
    for (const Group& group : term_->groups_)
      for (std::int32_t a = 0; a < group.nodes.count; ++a)
        term_->gradients_[std::size_t(group.nodes.first + a)] /= group.volume_mm3;
    term_->nodes_ = nodes_.take();
    return std::move(term_);
  }

 private:
  /// Until all sides are added, gradients_ holds sums of gradient times volume.
  void add_side(const Side& side) {
    Group& group = term_->groups_.back();
    group.volume_mm3 += side.volume_mm3;
    Index gradient = side.first_gradient;
    for (const std::int32_t node : parts_[std::size_t(side.part)]) {
      const auto place = std::size_t(group.nodes.first + nodes_.add(node));
      if (place == term_->gradients_.size()) term_->gradients_.emplace_back(Vec3::Zero());
      term_->gradients_[place] += side.volume_mm3 * side_gradients_[std::size_t(gradient++)];
    }
    group.nodes = nodes_.last();
    term_->domains_[std::size_t(side.place)].item = std::int32_t(term_->groups_.size()) - 1;
  }

  std::unique_ptr<SmoothedStrainTerm> term_{new SmoothedStrainTerm()};
  NodeListBuilder nodes_;
  std::vector<Part> parts_;
  std::vector<Side> domains_;
  std::vector<Vec3> side_gradients_;
};

std::unique_ptr<SmoothedStrainTerm> SmoothedStrainTerm::build(const mesh::VolumeMesh& mesh,
                                                              const RegionMaterials& materials) {
  Builder builder;
  for_each_decoupled_element(
      mesh, materials,
      [&]<class Element>(const Element&, auto nodes, std::int32_t region) {
        if constexpr (0 < kSmoothingDomains<Element>)
          builder.template add_element<Element>(mesh, nodes, region);
      },
      [&] { builder.end_element(); });
  return builder.build(materials);
}

std::span<const std::int32_t> SmoothedStrainTerm::nodes(Index item) const {
  const Group& group = groups_[std::size_t(item)];
  return {nodes_.data() + group.nodes.first, std::size_t(group.nodes.count)};
}

std::span<const SmoothedStrainTerm::ElementDomain> SmoothedStrainTerm::domains_of(
    Index number) const {
  const std::int32_t first = number == 0 ? 0 : end_of_domains_[std::size_t(number) - 1];
  return {domains_.data() + first, std::size_t(end_of_domains_[std::size_t(number)] - first)};
}

Mat3 SmoothedStrainTerm::mean_gradient(const Group& group, std::span<const Vec3> x_L) const {
  Mat3 F = Mat3::Zero();
  for (std::size_t a = 0; a < x_L.size(); ++a)
    F.noalias() += x_L[a] * gradients_[std::size_t(group.nodes.first) + a].transpose();
  return F;
}

bool SmoothedStrainTerm::evaluate(Index item, std::span<const Vec3> x_L,
                                  LocalEquations& local) const {
  const Group& group = groups_[std::size_t(item)];
  const Material& material = materials_[std::size_t(group.material)];
  const Mat3 F = mean_gradient(group, x_L);
  if (!(volume_ratio(F) > 0.0)) return false;  // Also if NaN.
  const std::span g(gradients_.data() + group.nodes.first, x_L.size());
  const double dV = (1.0 - kElementStabilizationFraction) * group.volume_mm3;
  const Mat3 P_dV = dV * stress(material, LawPart::kWhole, F);
  local.energy_mj = dV * energy(material, LawPart::kWhole, F);
  for (std::size_t a = 0; a < g.size(); ++a)
    local.residual_n.segment<3>(3 * Index(a)) = P_dV * g[a];
  if (!local.wants_stiffness()) return true;

  const Mat9 A = dV * tangent(material, LawPart::kWhole, F);
  for (std::size_t b = 0; b < g.size(); ++b) {
    const Eigen::Matrix<double, 9, 3> dP =
        g[b][0] * A.leftCols<3>() + g[b][1] * A.middleCols<3>(3) + g[b][2] * A.rightCols<3>();
    for (std::size_t a = 0; a < g.size(); ++a)
      local.stiffness_n_per_mm.block<3, 3>(3 * Index(a), 3 * Index(b)) =
          g[a][0] * dP.topRows<3>() + g[a][1] * dP.middleRows<3>(3) + g[a][2] * dP.bottomRows<3>();
  }
  return true;
}

SmoothedStrainTerm::State SmoothedStrainTerm::state(Index item, std::span<const Vec3> x_L) const {
  const Group& group = groups_[std::size_t(item)];
  const Material& material = materials_[std::size_t(group.material)];
  std::array<Vec3, kMaxLocalNodes> local_x_L;
  const std::span<const std::int32_t> of_group = nodes(item);
  for (std::size_t a = 0; a < of_group.size(); ++a) local_x_L[a] = x_L[std::size_t(of_group[a])];
  const Mat3 F = mean_gradient(group, {local_x_L.data(), of_group.size()});
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  if (!(volume_ratio(F) > 0.0)) return {Mat3::Constant(kNan), kNan};
  return {cauchy_stress(stress(material, LawPart::kWhole, F), F),
          energy(material, LawPart::kWhole, F)};
}

}  // namespace lefort::fem
