#include <lefort/core/decompositions.h>
#include <lefort/solve/unconstrained_parts.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace lefort::solve {
namespace {

using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;

/// Disjoint sets of connected nodes (union-find).
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  std::int32_t root(std::int32_t node) {
    while (parent_[std::size_t(node)] != node) {
      std::int32_t& up = parent_[std::size_t(node)];
      up = parent_[std::size_t(up)];
      node = up;
    }
    return node;
  }
  /// The lower root remains, so that roots do not depend on the order of joining.
  void join(std::int32_t a, std::int32_t b) {
    const std::int32_t root_a = root(a), root_b = root(b);
    parent_[std::size_t(std::max(root_a, root_b))] = std::min(root_a, root_b);
  }

 private:
  std::vector<std::int32_t> parent_;
};

/// A part and its constraints.
struct Part {
  UnconstrainedPart reported;
  Vec3 center_L = Vec3::Zero();
  double size_mm = 0.0;  ///< Largest distance of a node from the center.
  Mat6 constrained = Mat6::Zero();
};

std::vector<Part> connected_parts(const mesh::VolumeMesh& mesh,
                                  std::vector<std::int32_t>& part_of) {
  DisjointSets joined(mesh.nodes_L.size());
  for (const mesh::ElementBlock& block : mesh.blocks)
    for (Index e = 0; e < block.element_count(); ++e)
      for (int a = 1; a < mesh::node_count(block.shape); ++a)
        joined.join(block.element(e)[0], block.element(e)[a]);

  std::vector<Part> parts;
  std::vector<std::int32_t> part_of_root(mesh.nodes_L.size(), -1);
  Index number = 0;
  for (const mesh::ElementBlock& block : mesh.blocks)
    for (Index e = 0; e < block.element_count(); ++e, ++number) {
      std::int32_t& part = part_of_root[std::size_t(joined.root(block.element(e)[0]))];
      if (part < 0) {
        part = std::int32_t(parts.size());
        UnconstrainedPart& reported = parts.emplace_back().reported;
        reported.first_element = number;
        for (int a = 0; a < mesh::node_count(block.shape); ++a)
          reported.at_L += mesh.nodes_L[std::size_t(block.element(e)[a])] /
                           double(mesh::node_count(block.shape));
      }
      ++parts[std::size_t(part)].reported.elements;
    }
  part_of.assign(mesh.nodes_L.size(), -1);
  for (std::size_t n = 0; n < part_of.size(); ++n) {
    part_of[n] = part_of_root[std::size_t(joined.root(std::int32_t(n)))];
    if (part_of[n] >= 0) parts[std::size_t(part_of[n])].reported.nodes.push_back(std::int32_t(n));
  }
  return parts;
}

void measure(const mesh::VolumeMesh& mesh, Part& part) {
  for (const std::int32_t node : part.reported.nodes)
    part.center_L += mesh.nodes_L[std::size_t(node)] / double(part.reported.nodes.size());
  for (const std::int32_t node : part.reported.nodes)
    part.size_mm = std::max(part.size_mm, (mesh.nodes_L[std::size_t(node)] - part.center_L).norm());
}

std::string describe(const Vec3& direction) {
  constexpr double kZero = 5e-4;  // Not "-0".
  const auto shown = [](double x) { return std::abs(x) < kZero ? 0.0 : x; };
  return fmt::format("({:.3g}, {:.3g}, {:.3g})", shown(direction.x()), shown(direction.y()),
                     shown(direction.z()));
}

/// \param motion  translation, then rotation times the part's size.
std::string describe(const Vec6& motion) {
  const Vec3 translation = motion.head<3>(), rotation = motion.tail<3>();
  return translation.norm() > rotation.norm()
             ? "move along " + describe(Vec3(translation.normalized()))
             : "rotate about " + describe(Vec3(rotation.normalized()));
}

}  // namespace

std::vector<UnconstrainedPart> find_unconstrained_parts(
    const mesh::VolumeMesh& mesh, std::span<const fem::PrescribedDisplacement> prescribed) {
  constexpr double kRoundOff = 1e-10;
  std::vector<std::int32_t> part_of;
  std::vector<Part> parts = connected_parts(mesh, part_of);
  for (Part& part : parts) measure(mesh, part);

  for (const fem::PrescribedDisplacement& p : prescribed) {
    const std::int32_t number = part_of[std::size_t(p.node)];
    if (number < 0) continue;
    Part& part = parts[std::size_t(number)];
    // u = t + r x d, so that u . e = t . e + r . (d x e).
    const Vec3 d = (mesh.nodes_L[std::size_t(p.node)] - part.center_L) / part.size_mm;
    Vec6 row;
    row << Vec3::Unit(p.component), d.cross(Vec3::Unit(p.component));
    part.constrained += row * row.transpose();
  }

  std::vector<UnconstrainedPart> unconstrained;
  for (Part& part : parts) {
    const SymmetricEigen<6> eigen = symmetric_eigen(part.constrained);
    const double minimum = kRoundOff * std::max(eigen.values[5], 1.0);
    part.reported.free_motions = int((eigen.values.array() <= minimum).count());
    if (part.reported.free_motions == 0) continue;
    part.reported.motion = describe(Vec6(eigen.vectors.col(0)));
    unconstrained.push_back(std::move(part.reported));
  }
  return unconstrained;
}

}  // namespace lefort::solve
