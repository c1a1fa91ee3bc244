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

/// One smoothing domain of one element.
struct Domain {
  std::array<std::int32_t, 4> shared;  ///< Nodes that identify its group.
  std::int32_t region;
  std::int32_t element;  ///< Among the elements that were added.
  std::int32_t number;   ///< Among the domains of all elements.
  Index first_gradient;
  double volume_mm3;
};

bool are_in_one_group(const Domain& a, const Domain& b) {
  return a.shared == b.shared && a.region == b.region;
}

/// The nodes of one element.
using ElementNodeList = std::span<const std::int32_t>;

std::pair<std::int32_t, std::int32_t> ascending(std::int32_t a, std::int32_t b) {
  return {std::min(a, b), std::max(a, b)};
}

/// \returns the ends of edge k.
std::array<std::int32_t, 4> shared_nodes(const Tet4&, const std::int32_t* nodes, std::size_t k) {
  const auto [i, j] = Tet10::kEdges[k];
  const auto [low, high] = ascending(nodes[i], nodes[j]);
  return {low, high, -1, -1};
}

/// \returns the corners of quadrilateral face k % 3, those of the nearer triangle first.
std::array<std::int32_t, 4> shared_nodes(const Wedge6&, const std::int32_t* nodes, std::size_t k) {
  constexpr std::array<std::pair<int, int>, 3> kEdges{{{1, 2}, {2, 0}, {0, 1}}};
  const auto [i, j] = kEdges[k % 3];
  const auto [low, high] = ascending(nodes[i], nodes[j]);
  const auto [upper_low, upper_high] = ascending(nodes[i + 3], nodes[j + 3]);
  if (k < 3) return {low, high, upper_low, upper_high};
  return {upper_low, upper_high, low, high};
}

}  // namespace

/// Collects the elements, then sorts their domains into groups.
class SmoothedStrainTerm::Builder {
 public:
  template <class Element>
  void add_element(const mesh::VolumeMesh& mesh, const std::int32_t* nodes, std::int32_t region) {
    ElementNodes<Element> X;
    for (int a = 0; a < Element::kNodes; ++a) X.col(a) = mesh.nodes_L[std::size_t(nodes[a])];
    const auto domains = smoothing_domains<Element>(X);
    LEFORT_CHECK(domains.has_value());
    double volume_mm3 = 0.0;
    for (const auto& domain : *domains) volume_mm3 += domain.volume_mm3;
    for (std::size_t k = 0; k < domains->size(); ++k) {
      const auto& domain = (*domains)[k];
      domains_.push_back({.shared = shared_nodes(Element{}, nodes, k),
                          .region = region,
                          .element = std::int32_t(element_nodes_.size()),
                          .number = std::int32_t(domains_.size()),
                          .first_gradient = Index(domain_gradients_.size()),
                          .volume_mm3 = domain.volume_mm3});
      for (int a = 0; a < Element::kNodes; ++a) domain_gradients_.emplace_back(domain.dN_dX.col(a));
      term_->domains_.push_back({.fraction = domain.volume_mm3 / volume_mm3});
    }
    element_nodes_.emplace_back(nodes, std::size_t(Element::kNodes));
  }

  /// Call after each element of the mesh, whether or not it was added.
  void end_element() { term_->end_of_domains_.push_back(std::int32_t(domains_.size())); }

  std::unique_ptr<SmoothedStrainTerm> build(const RegionMaterials& materials) {
    if (domains_.empty()) return nullptr;
    std::ranges::sort(domains_, [](const Domain& a, const Domain& b) {
      return std::tie(a.shared, a.region, a.element) < std::tie(b.shared, b.region, b.element);
    });
    std::map<std::int32_t, std::int32_t> material_of_region;
    for (std::size_t k = 0; k < domains_.size(); ++k) {
      const Domain& domain = domains_[k];
      if (k == 0 || !are_in_one_group(domains_[k - 1], domain) ||
          !nodes_.has_room_for(element_nodes_[std::size_t(domain.element)])) {
        const auto [material, is_new] =
            material_of_region.try_emplace(domain.region, std::int32_t(term_->materials_.size()));
        if (is_new)
          term_->materials_.push_back(element_law_without_nodal_part(materials.at(domain.region)));
        nodes_.open();
        term_->groups_.push_back({.nodes = nodes_.last(), .material = material->second});
      }
      add_domain(domain);
    }
    for (const Group& group : term_->groups_)
      for (std::int32_t a = 0; a < group.nodes.count; ++a)
        term_->gradients_[std::size_t(group.nodes.first + a)] /= group.volume_mm3;
    term_->nodes_ = nodes_.take();
    return std::move(term_);
  }

 private:
  /// Until all domains are added, gradients_ holds sums of gradient times volume.
  void add_domain(const Domain& domain) {
    Group& group = term_->groups_.back();
    group.volume_mm3 += domain.volume_mm3;
    Index gradient = domain.first_gradient;
    for (const std::int32_t node : element_nodes_[std::size_t(domain.element)]) {
      const auto place = std::size_t(group.nodes.first + nodes_.add(node));
      if (place == term_->gradients_.size()) term_->gradients_.emplace_back(Vec3::Zero());
      term_->gradients_[place] += domain.volume_mm3 * domain_gradients_[std::size_t(gradient++)];
    }
    group.nodes = nodes_.last();
    term_->domains_[std::size_t(domain.number)].item = std::int32_t(term_->groups_.size()) - 1;
  }

  std::unique_ptr<SmoothedStrainTerm> term_{new SmoothedStrainTerm()};
  NodeListBuilder nodes_;
  std::vector<ElementNodeList> element_nodes_;
  std::vector<Domain> domains_;
  std::vector<Vec3> domain_gradients_;
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
