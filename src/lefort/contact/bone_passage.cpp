#include <lefort/contact/bone_passage.h>
#include <lefort/contact/measure_gap.h>
#include <lefort/core/parallel.h>
#include <lefort/mesh/boundary_faces.h>
#include <lefort/mesh/element_faces.h>

#include <algorithm>
#include <vector>

namespace lefort::contact {
namespace {

/// Signed distance of a point from the body, at most the maximum distance of the query [mm].
double gap_mm(const RigidObstacle& at_origin, const Vec3& p_B) {
  return measure_gap(at_origin, p_B, Derivatives::kFirst).gap_mm;
}

/// Largest depth in the body on the segment from a to b [mm]; 0 if it stays outside. A signed
/// distance changes at most by the distance moved, so that steps of that distance skip nothing
/// (sphere tracing). Parts thinner than the smallest step are below the resolution of the query.
double deepest_mm(const RigidObstacle& at_origin, const Vec3& a, const Vec3& b,
                  double min_step_mm) {
  const double length_mm = (b - a).norm();
  double deepest = 0.0;
  for (double along_mm = 0.0; along_mm < length_mm;) {
    const double gap = gap_mm(at_origin, a + along_mm / length_mm * (b - a));
    deepest = std::max(deepest, -gap);
    along_mm += std::max(gap / kMaxGapSlope, min_step_mm);
  }
  return deepest;
}

/// Nodes and centers of the faces, in the frame of the body [mm].
std::vector<Vec3> points_B(std::span<const mesh::Face> faces, std::span<const std::int32_t> nodes,
                           const RigidTransform& X_LB, std::span<const Vec3> x_L) {
  std::vector<Vec3> points;
  points.reserve(nodes.size() + faces.size());
  const RigidTransform X_BL = X_LB.inverse();
  for (const std::int32_t node : nodes) points.emplace_back(X_BL * x_L[std::size_t(node)]);
  for (const mesh::Face& face : faces) {
    const auto of_face = mesh::nodes_of(face);
    Vec3 sum = Vec3::Zero();
    for (const std::int32_t node : of_face) sum += x_L[std::size_t(node)];
    points.emplace_back(X_BL * Vec3(sum / double(of_face.size())));
  }
  return points;
}

}  // namespace

std::optional<Vec3> find_passage(const RigidObstacle& obstacle, std::span<const mesh::Face> faces,
                                 const RigidTransform& from_X_LB, std::span<const Vec3> from_L,
                                 std::span<const Vec3> to_L) {
  constexpr double kCells = 2.0, kMinStep = 0.5;  // Of the resolution of the query.
  const double cell_mm = obstacle.distance_query_B->resolution_mm();
  const RigidObstacle at_origin{.distance_query_B = obstacle.distance_query_B};
  const std::vector<std::int32_t> nodes = mesh::nodes_of_faces(faces);
  const std::vector<Vec3> from_B = points_B(faces, nodes, from_X_LB, from_L);
  const std::vector<Vec3> to_B = points_B(faces, nodes, obstacle.X_LB, to_L);
  std::vector<double> excess_mm(to_B.size(), 0.0);
  parallel_for(Index(to_B.size()), [&](Index k) {
    const Vec3 &from = from_B[std::size_t(k)], &to = to_B[std::size_t(k)];
    if ((to - from).norm() <= kCells * cell_mm || gap_mm(at_origin, from) < 0.0) return;
    const double deepest = deepest_mm(at_origin, from, to, kMinStep * cell_mm);
    excess_mm[std::size_t(k)] = deepest - std::max(-gap_mm(at_origin, to), 0.0);
  });
  const auto maximum = std::max_element(excess_mm.begin(), excess_mm.end());
  if (maximum == excess_mm.end() || *maximum <= kCells * cell_mm) return std::nullopt;
  return obstacle.X_LB * to_B[std::size_t(maximum - excess_mm.begin())];
}

}  // namespace lefort::contact
