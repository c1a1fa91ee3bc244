#include <lefort/core/check.h>
#include <lefort/mesh/boundary_faces.h>
#include <lefort/mesh/element_faces.h>
#include <lefort/mesh/fit_mid_edge_nodes.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace lefort::mesh {
namespace {

constexpr double kMaxEdgeFraction = 0.25;      // Of the length of the edge.
constexpr double kToleranceFraction = 1.0e-3;  // Of the length of the edge.
constexpr double kMinDirection = 0.1;          // Length of a unit normal without its plane part.
constexpr double kMinScale = 0.25;             // A smaller part of a displacement is none.

/// Barycentric coordinates at which det J is evaluated: the nodes of the tet10 and the four
/// quadrature points of degree 2 (fem/elements/tet10.h).
std::vector<Eigen::Vector4d> sample_points() {
  std::vector<Eigen::Vector4d> points;
  const double far = (5.0 - std::sqrt(5.0)) / 20.0, near = (5.0 + 3.0 * std::sqrt(5.0)) / 20.0;
  for (int i = 0; i < 4; ++i) {
    points.emplace_back(Eigen::Vector4d::Unit(i));
    points.emplace_back(Eigen::Vector4d::Constant(far))[i] = near;
    for (int j = 0; j < i; ++j)
      points.emplace_back(0.5 * (Eigen::Vector4d::Unit(i) + Eigen::Vector4d::Unit(j)));
  }
  return points;
}

/// det J of a tet10 at the point with barycentric coordinates L.
double jacobian_at(const std::array<Vec3, 10>& x, const Eigen::Vector4d& L) {
  std::array<Vec3, 4> dx_dL;
  for (int i = 0; i < 4; ++i) dx_dL[std::size_t(i)] = (4.0 * L[i] - 1.0) * x[std::size_t(i)];
  const auto edges = edges_of(ElementShape::kTet10);
  for (std::size_t n = 0; n < edges.size(); ++n) {
    const auto [i, j] = edges[n];
    dx_dL[std::size_t(i)] += 4.0 * L[j] * x[4 + n];
    dx_dL[std::size_t(j)] += 4.0 * L[i] * x[4 + n];
  }
  return (dx_dL[1] - dx_dL[0]).cross(dx_dL[2] - dx_dL[0]).dot(dx_dL[3] - dx_dL[0]);
}

class MidEdgeFit {
 public:
  MidEdgeFit(QuadraticMesh& quadratic, const CurvedSurface& surface)
      : quadratic_(quadratic),
        surface_(surface),
        first_(quadratic.corner_count()),
        normals_L_(quadratic.ends.size(), Vec3::Zero()),
        offsets_L_(quadratic.ends.size(), Vec3::Zero()),
        scales_(quadratic.ends.size(), 1.0) {}

  /// Sum of the normals of the faces at each mid-edge node; zero at nodes that do not move.
  void find_normals(std::span<const Face> straight) {
    std::vector<char> is_straight(normals_L_.size(), 0);
    for (const Face& face : straight)
      for (int i = 3; i < 6; ++i) is_straight[middle_of(face, i)] = 1;
    for (const Face& face : boundary_faces(quadratic_.mesh)) {
      const Vec3 &a = corner(face, 0), &b = corner(face, 1), &c = corner(face, 2);
      if (!surface_.planes_at_L((a + b + c) / 3.0).empty()) continue;
      for (int i = 3; i < 6; ++i) normals_L_[middle_of(face, i)] += (b - a).cross(c - a);
    }
    for (std::size_t m = 0; m < normals_L_.size(); ++m)
      if (is_straight[m] != 0) normals_L_[m].setZero();
  }

  void find_offsets() {
    for (std::size_t m = 0; m < normals_L_.size(); ++m)
      if (normals_L_[m].squaredNorm() > 0.0) offsets_L_[m] = offset_of(m);
  }

  /// Shortens offsets until every element is admissible; each pass halves those of bad elements.
  void limit() {
    while (shorten()) {
    }
  }

  [[nodiscard]] CurvedMesh finished() {
    CurvedMesh result;
    for (std::size_t m = 0; m < offsets_L_.size(); ++m) {
      const Vec3 moved = scales_[m] * offsets_L_[m];
      if (offsets_L_[m].squaredNorm() > 0.0) ++(scales_[m] < 1.0 ? result.limited : result.curved);
      result.max_mm = std::max(result.max_mm, moved.norm());
    }
    const ElementBlock& block = quadratic_.mesh.blocks.front();
    for (Index e = 0; e < block.element_count(); ++e)
      result.min_ratio = std::min(result.min_ratio, min_ratio(block.element(e)));
    for (std::size_t m = 0; m < offsets_L_.size(); ++m)
      quadratic_.mesh.nodes_L[std::size_t(first_) + m] += scales_[m] * offsets_L_[m];
    result.quadratic = std::move(quadratic_);
    return result;
  }

 private:
  [[nodiscard]] std::size_t middle_of(const Face& face, int i) const {
    return std::size_t(Index(face.nodes[std::size_t(i)]) - first_);
  }
  [[nodiscard]] const Vec3& corner(const Face& face, int i) const {
    return quadratic_.mesh.nodes_L[std::size_t(face.nodes[std::size_t(i)])];
  }

  /// From the middle of an edge to the surface; zero if it is too far.
  [[nodiscard]] Vec3 offset_of(std::size_t m) const {
    const std::vector<Vec3>& nodes_L = quadratic_.mesh.nodes_L;
    const auto [i, j] = quadratic_.ends[m];
    const double length_mm = (nodes_L[std::size_t(i)] - nodes_L[std::size_t(j)]).norm();
    const Vec3& p_L = nodes_L[std::size_t(first_) + m];
    Vec3 direction = normals_L_[m].normalized();
    for (const Vec3& normal_L : surface_.planes_at_L(p_L))
      direction -= normal_L.dot(direction) * normal_L;
    if (!(direction.norm() > kMinDirection)) return Vec3::Zero();
    direction.normalize();
    const std::optional<double> t_mm =
        find_zero_crossing(p_L, direction, surface_.is_inside_L, kMaxEdgeFraction * length_mm,
                           kToleranceFraction * length_mm);
    return t_mm ? Vec3(*t_mm * direction) : Vec3::Zero();
  }

  /// det J of an element divided by its value with straight edges, min over the sample points.
  [[nodiscard]] double min_ratio(const std::int32_t* element) const {
    static const std::vector<Eigen::Vector4d> points = sample_points();
    std::array<Vec3, 10> x;
    bool is_curved = false;
    for (std::size_t n = 0; n < x.size(); ++n) {
      x[n] = quadratic_.mesh.nodes_L[std::size_t(element[n])];
      if (n < 4) continue;
      const auto m = std::size_t(Index(element[n]) - first_);
      const Vec3 moved = scales_[m] * offsets_L_[m];
      is_curved = is_curved || moved.squaredNorm() > 0.0;
      x[n] += moved;
    }
    if (!is_curved) return 1.0;
    const double straight = (x[1] - x[0]).cross(x[2] - x[0]).dot(x[3] - x[0]);
    double least = std::numeric_limits<double>::infinity();
    for (const Eigen::Vector4d& L : points) least = std::min(least, jacobian_at(x, L) / straight);
    return least;
  }

  /// \returns whether an offset was shortened.
  bool shorten() {
    const ElementBlock& block = quadratic_.mesh.blocks.front();
    std::vector<char> is_bad(scales_.size(), 0);
    for (Index e = 0; e < block.element_count(); ++e) {
      const std::int32_t* element = block.element(e);
      if (min_ratio(element) >= kMinJacobianRatio) continue;
      for (int n = 4; n < 10; ++n) is_bad[std::size_t(Index(element[n]) - first_)] = 1;
    }
    bool is_shortened = false;
    for (std::size_t m = 0; m < scales_.size(); ++m) {
      if (is_bad[m] == 0 || scales_[m] == 0.0 || !(offsets_L_[m].squaredNorm() > 0.0)) continue;
      scales_[m] = 0.5 * scales_[m] < kMinScale ? 0.0 : 0.5 * scales_[m];
      is_shortened = true;
    }
    return is_shortened;
  }

  QuadraticMesh& quadratic_;
  const CurvedSurface& surface_;
  Index first_;  ///< Number of the first mid-edge node.
  std::vector<Vec3> normals_L_, offsets_L_;
  std::vector<double> scales_;  ///< Part of each offset that is applied.
};

}  // namespace

CurvedMesh fit_mid_edge_nodes(QuadraticMesh quadratic, const CurvedSurface& surface,
                              std::span<const Face> straight) {
  LEFORT_CHECK(quadratic.mesh.blocks.size() == 1 &&
               quadratic.mesh.blocks.front().shape == ElementShape::kTet10);
  MidEdgeFit fit(quadratic, surface);
  fit.find_normals(straight);
  fit.find_offsets();
  fit.limit();
  return fit.finished();
}

}  // namespace lefort::mesh
