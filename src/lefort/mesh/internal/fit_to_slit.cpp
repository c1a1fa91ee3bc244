#include <lefort/mesh/boundary_faces.h>
#include <lefort/mesh/element_quality.h>
#include <lefort/mesh/find_zero_crossing.h>
#include <lefort/mesh/internal/fit_to_slit.h>
#include <lefort/mesh/internal/users_of_nodes.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace lefort::mesh::internal {
namespace {

constexpr int kSweeps = 5;
/// A move may lower the scaled Jacobian of an element to this: ten times the limit of meshes with
/// skin, 0.05, would forbid most moves; twice keeps a margin.
constexpr double kMinJacobian = 0.1;
constexpr double kReach_mm = 0.5;       ///< Search of the boundary next to a moved boundary node.
constexpr double kTolerance_mm = 0.01;  ///< As TetOptions::level_tolerance_mm.
constexpr double kDifference_mm = 0.05;
constexpr double kRidge_cos = 0.77;  ///< Of 40 degrees: nodes between steeper faces do not move.

class SlitFit {
 public:
  SlitFit(VolumeMesh& mesh, const SlitSurface& surface, std::span<const InnerFace> faces,
          const std::function<bool(const Vec3&)>& is_inside_L)
      : mesh_(mesh), surface_(surface), is_inside_L_(is_inside_L), elements_(elements_of(mesh)) {
    users_ = users_of_nodes(mesh.node_count(), Index(elements_.size()), [&](Index e) {
      const ElementNodes& element = elements_[std::size_t(e)];
      return std::span(element.nodes, std::size_t(node_count(element.shape)));
    });
    std::vector<Face> cut;
    for (const InnerFace& face : faces)
      if (face.is_on_slit) cut.push_back(face.face);
    nodes_ = nodes_of_faces(cut);
    find_normals();
  }

  double run() {
    for (int sweep = 0; sweep < kSweeps; ++sweep)
      for (const std::int32_t node : nodes_) move(std::size_t(node));
    double sum = 0.0;
    for (const std::int32_t node : nodes_) {
      const double mm = surface_.level_set_L(mesh_.nodes_L[std::size_t(node)]);
      sum += mm * mm;
    }
    return nodes_.empty() ? 0.0 : std::sqrt(sum / double(nodes_.size()));
  }

 private:
  /// Normals of boundary nodes; zero on ridges.
  void find_normals() {
    const std::vector<Face3> triangles = triangles_of(boundary_faces(mesh_));
    normal_L_.assign(mesh_.nodes_L.size(), std::nullopt);
    const auto area = [&](const Face3& face) {
      const auto corner = [&](std::size_t n) { return mesh_.nodes_L[std::size_t(face[n])]; };
      return Vec3((corner(1) - corner(0)).cross(corner(2) - corner(0)));
    };
    for (const Face3& face : triangles)
      for (const std::int32_t node : face) {
        auto& normal = normal_L_[std::size_t(node)];
        normal = normal.value_or(Vec3::Zero()) + area(face);
      }
    for (auto& normal : normal_L_)
      if (normal && normal->norm() > 0.0) normal->normalize();
    for (const Face3& face : triangles)
      for (const std::int32_t node : face)
        if (auto& normal = normal_L_[std::size_t(node)];
            !(area(face).normalized().dot(*normal) > kRidge_cos))
          is_ridge_.push_back(node);
    for (const std::int32_t node : is_ridge_) normal_L_[std::size_t(node)] = Vec3::Zero();
  }

  [[nodiscard]] Vec3 gradient_at(const Vec3& p_L) const {
    Vec3 gradient;
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 d = kDifference_mm * Vec3::Unit(axis);
      gradient[axis] =
          (surface_.level_set_L(p_L + d) - surface_.level_set_L(p_L - d)) / (2.0 * kDifference_mm);
    }
    return gradient;
  }

  /// Smallest scaled Jacobian of the elements around a node, if it were at `p_L`.
  [[nodiscard]] double quality(std::size_t node, const Vec3& p_L) const {
    double least = 1.0;
    std::array<Vec3, 8> corners;
    for (const Index e : users_.of(node)) {
      const auto& [shape, nodes] = elements_[std::size_t(e)];
      const auto count = std::size_t(node_count(shape));
      for (std::size_t n = 0; n < count; ++n)
        corners[n] = std::size_t(nodes[n]) == node ? p_L : mesh_.nodes_L[std::size_t(nodes[n])];
      least = std::min(least, scaled_jacobian(shape, {corners.data(), count}));
    }
    return least;
  }

  [[nodiscard]] bool is_movable(std::size_t node) const {
    const auto users = users_.of(node);
    if (normal_L_[node] && normal_L_[node]->isZero()) return false;
    return std::all_of(users.begin(), users.end(), [&](Index e) {
      return elements_[std::size_t(e)].shape == ElementShape::kTet4;
    });
  }

  void move(std::size_t node) {
    if (!is_movable(node)) return;
    const Vec3 p_L = mesh_.nodes_L[node];
    if (std::abs(surface_.level_set_L(p_L)) < kTolerance_mm) return;
    Vec3 direction = gradient_at(p_L);
    const auto& normal = normal_L_[node];
    if (normal) direction -= normal->dot(direction) * *normal;
    const double squared = direction.squaredNorm();
    if (squared < 0.1) return;  // The boundary is nearly parallel to the slit.
    const Vec3 step = -surface_.level_set_L(p_L) / squared * direction;
    const double floor = std::min(kMinJacobian, quality(node, p_L));
    for (const double fraction : {1.0, 0.5, 0.25}) {
      Vec3 moved_L = p_L + fraction * step;
      if (normal) {
        const auto t = find_zero_crossing(moved_L, *normal, is_inside_L_, kReach_mm, kTolerance_mm);
        if (!t) continue;
        moved_L += *t * *normal;
      }
      if (quality(node, moved_L) < floor) continue;
      mesh_.nodes_L[node] = moved_L;
      return;
    }
  }

  VolumeMesh& mesh_;
  const SlitSurface& surface_;
  const std::function<bool(const Vec3&)>& is_inside_L_;
  std::vector<ElementNodes> elements_;
  Lists users_;
  std::vector<std::int32_t> nodes_, is_ridge_;
  std::vector<std::optional<Vec3>> normal_L_;
};

}  // namespace

double fit_to_slit(VolumeMesh& mesh, const SlitSurface& surface, std::span<const InnerFace> faces,
                   const std::function<bool(const Vec3&)>& is_inside_L) {
  return SlitFit(mesh, surface, faces, is_inside_L).run();
}

}  // namespace lefort::mesh::internal
