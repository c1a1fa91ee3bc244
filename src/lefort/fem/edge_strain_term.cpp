#include <lefort/core/check.h>
#include <lefort/fem/deformation.h>
#include <lefort/fem/dilatation.h>
#include <lefort/fem/edge_strain_term.h>
#include <lefort/fem/elements/tet10.h>
#include <lefort/fem/elements/tet4.h>
#include <lefort/fem/material_response.h>
#include <lefort/fem/reference_element.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

namespace lefort::fem {
namespace {

/// One edge of one element.
struct Side {
  std::int32_t low;  ///< Its ends, the lower first.
  std::int32_t high;
  std::int32_t region;
  std::int32_t part;   ///< Which element, of those that take part.
  std::int32_t place;  ///< In the list of all sides.
};

bool belong_together(const Side& a, const Side& b) {
  return a.low == b.low && a.high == b.high && a.region == b.region;
}

struct Part {
  const std::int32_t* nodes;  ///< Four.
  ReferencePoint<Tet4> point;
};

}  // namespace

/// Collects elements, then sorts their sides into edges.
class EdgeStrainTerm::Builder {
 public:
  void add_element(const mesh::VolumeMesh& mesh, const std::int32_t* nodes, std::int32_t region) {
    ElementNodes<Tet4> X;
    for (int a = 0; a < Tet4::kNodes; ++a) X.col(a) = mesh.nodes_L[std::size_t(nodes[a])];
    const auto reference = reference_element<Tet4>(X);
    LEFORT_CHECK(reference.has_value());
    for (const auto& [i, j] : Tet10::kEdges)
      sides_.push_back({.low = std::min(nodes[i], nodes[j]),
                        .high = std::max(nodes[i], nodes[j]),
                        .region = region,
                        .part = std::int32_t(parts_.size()),
                        .place = std::int32_t(sides_.size())});
    parts_.push_back({.nodes = nodes, .point = reference->front()});
  }

  /// To be called after each element of the mesh, whether or not it was added.
  void end_element() { term_->end_of_sides_.push_back(std::int32_t(sides_.size())); }

  std::unique_ptr<EdgeStrainTerm> build(const RegionMaterials& materials) {
    if (sides_.empty()) return nullptr;
    std::ranges::sort(sides_, [](const Side& a, const Side& b) {
      return std::tie(a.low, a.high, a.region, a.part) < std::tie(b.low, b.high, b.region, b.part);
    });
    term_->edge_of_side_.resize(sides_.size());
    std::map<std::int32_t, std::int32_t> place_of_region;
    for (std::size_t k = 0; k < sides_.size(); ++k) {
      const Side& side = sides_[k];
      if (k == 0 || !belong_together(sides_[k - 1], side) || !nodes_.has_room_for(nodes_of(side))) {
        const auto [place, is_new] =
            place_of_region.try_emplace(side.region, std::int32_t(term_->materials_.size()));
        if (is_new) term_->materials_.push_back(materials.at(side.region));
        nodes_.open();
        term_->edges_.push_back({.nodes = nodes_.last(), .material = place->second});
      }
      add_side(side);
    }
    for (const Edge& edge : term_->edges_)
      for (std::int32_t a = 0; a < edge.nodes.count; ++a)
        term_->gradients_[std::size_t(edge.nodes.first + a)] /= edge.volume_mm3;
    term_->nodes_ = nodes_.take();
    return std::move(term_);
  }

 private:
  [[nodiscard]] std::span<const std::int32_t> nodes_of(const Side& side) const {
    return {parts_[std::size_t(side.part)].nodes, std::size_t(Tet4::kNodes)};
  }

  /// Until all sides are added, gradients_ holds sums of gradient times volume.
  void add_side(const Side& side) {
    constexpr double kShare = 1.0 / 6.0;
    Edge& edge = term_->edges_.back();
    const Part& part = parts_[std::size_t(side.part)];
    const double volume_mm3 = kShare * part.point.volume_mm3;
    edge.volume_mm3 += volume_mm3;
    for (int a = 0; a < Tet4::kNodes; ++a) {
      const auto place = std::size_t(edge.nodes.first + nodes_.add(part.nodes[a]));
      if (place == term_->gradients_.size()) term_->gradients_.emplace_back(Vec3::Zero());
      term_->gradients_[place] += volume_mm3 * part.point.dN_dX.col(a);
    }
    edge.nodes = nodes_.last();
    term_->edge_of_side_[std::size_t(side.place)] = std::int32_t(term_->edges_.size()) - 1;
  }

  std::unique_ptr<EdgeStrainTerm> term_{new EdgeStrainTerm()};
  PatchNodes nodes_;
  std::vector<Part> parts_;
  std::vector<Side> sides_;
};

std::unique_ptr<EdgeStrainTerm> EdgeStrainTerm::build(const mesh::VolumeMesh& mesh,
                                                      const RegionMaterials& materials) {
  Builder builder;
  for (const mesh::ElementBlock& block : mesh.blocks)
    for (Index e = 0; e < block.element_count(); ++e) {
      const std::int32_t region = block.region[std::size_t(e)];
      const auto material = materials.find(region);
      LEFORT_CHECK(material != materials.end());
      if (block.shape == mesh::ElementShape::kTet4 && volumetric_part(material->second) != nullptr)
        builder.add_element(mesh, block.element(e), region);
      builder.end_element();
    }
  return builder.build(materials);
}

std::span<const std::int32_t> EdgeStrainTerm::nodes(Index item) const {
  const Edge& edge = edges_[std::size_t(item)];
  return {nodes_.data() + edge.nodes.first, std::size_t(edge.nodes.count)};
}

std::span<const std::int32_t> EdgeStrainTerm::edges_of(Index number) const {
  const std::int32_t first = number == 0 ? 0 : end_of_sides_[std::size_t(number) - 1];
  return {edge_of_side_.data() + first, std::size_t(end_of_sides_[std::size_t(number)] - first)};
}

Mat3 EdgeStrainTerm::mean_gradient(const Edge& edge, std::span<const Vec3> x_L) const {
  Mat3 F = Mat3::Zero();
  for (std::size_t a = 0; a < x_L.size(); ++a)
    F.noalias() += x_L[a] * gradients_[std::size_t(edge.nodes.first) + a].transpose();
  return F;
}

bool EdgeStrainTerm::evaluate(Index item, std::span<const Vec3> x_L, LocalEquations& local) const {
  const Edge& edge = edges_[std::size_t(item)];
  const Material& material = materials_[std::size_t(edge.material)];
  const Mat3 F = mean_gradient(edge, x_L);
  if (!(volume_ratio(F) > 0.0)) return false;  // Also if NaN.
  const std::span g(gradients_.data() + edge.nodes.first, x_L.size());
  const double dV = (1.0 - kRetainedShare) * edge.volume_mm3;
  const Mat3 P_dV = dV * stress(material, LawPart::kShear, F);
  local.energy_mj = dV * energy(material, LawPart::kShear, F);
  for (std::size_t a = 0; a < g.size(); ++a)
    local.residual_n.segment<3>(3 * Index(a)) = P_dV * g[a];
  if (!local.wants_stiffness()) return true;

  const Mat9 A = dV * tangent(material, LawPart::kShear, F);
  for (std::size_t b = 0; b < g.size(); ++b) {
    const Eigen::Matrix<double, 9, 3> dP =
        g[b][0] * A.leftCols<3>() + g[b][1] * A.middleCols<3>(3) + g[b][2] * A.rightCols<3>();
    for (std::size_t a = 0; a < g.size(); ++a)
      local.stiffness_n_per_mm.block<3, 3>(3 * Index(a), 3 * Index(b)) =
          g[a][0] * dP.topRows<3>() + g[a][1] * dP.middleRows<3>(3) + g[a][2] * dP.bottomRows<3>();
  }
  return true;
}

EdgeStrainTerm::State EdgeStrainTerm::state(Index item, std::span<const Vec3> x_L) const {
  const Edge& edge = edges_[std::size_t(item)];
  const Material& material = materials_[std::size_t(edge.material)];
  std::array<Vec3, kMaxLocalNodes> local_x_L;
  const std::span<const std::int32_t> of_edge = nodes(item);
  for (std::size_t a = 0; a < of_edge.size(); ++a) local_x_L[a] = x_L[std::size_t(of_edge[a])];
  const Mat3 F = mean_gradient(edge, {local_x_L.data(), of_edge.size()});
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  if (!(volume_ratio(F) > 0.0)) return {Mat3::Constant(kNan), kNan};
  return {cauchy_stress(stress(material, LawPart::kShear, F), F),
          energy(material, LawPart::kShear, F)};
}

}  // namespace lefort::fem
