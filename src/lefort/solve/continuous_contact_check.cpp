#include <lefort/contact/measure_gap.h>
#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/mesh/boundary_faces.h>
#include <lefort/mesh/element_faces.h>
#include <lefort/solve/continuous_contact_check.h>

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace lefort::solve {
namespace {

/// Signed distance of a point from the obstacle, at most the maximum distance of the query [mm].
double gap_mm(const contact::RigidObstacle& at_origin, const Vec3& p_B) {
  return contact::measure_gap(at_origin, p_B, contact::Derivatives::kFirst).gap_mm;
}

/// Largest depth in the obstacle on the segment from a to b [mm]; 0 if it stays outside. A signed
/// distance changes at most by the distance moved, so that steps of that distance skip nothing
/// (sphere tracing). Parts thinner than the smallest step are below the resolution of the query.
double deepest_mm(const contact::RigidObstacle& at_origin, const Vec3& a, const Vec3& b,
                  double min_step_mm) {
  const double length_mm = (b - a).norm();
  double deepest = 0.0;
  for (double along_mm = 0.0; along_mm < length_mm;) {
    const double gap = gap_mm(at_origin, a + along_mm / length_mm * (b - a));
    deepest = std::max(deepest, -gap);
    along_mm += std::max(gap, min_step_mm);
  }
  return deepest;
}

}  // namespace

ContinuousContactCheck::ContinuousContactCheck(std::span<const Vec3> nodes_L,
                                               std::vector<mesh::Face> faces, std::string obstacle)
    : name_(std::move(obstacle)), faces_(std::move(faces)), nodes_(mesh::nodes_of_faces(faces_)) {
  LEFORT_CHECK(nodes_.empty() || Index(nodes_.back()) < Index(nodes_L.size()));
}

std::vector<Vec3> ContinuousContactCheck::points_B(const contact::RigidObstacle& obstacle,
                                                   std::span<const Vec3> x_L) const {
  std::vector<Vec3> points;
  points.reserve(nodes_.size() + faces_.size());
  const RigidTransform X_BL = obstacle.X_LB.inverse();
  for (const std::int32_t node : nodes_) points.emplace_back(X_BL * x_L[std::size_t(node)]);
  for (const mesh::Face& face : faces_) {
    const auto of_face = mesh::nodes_of(face);
    Vec3 sum = Vec3::Zero();
    for (const std::int32_t node : of_face) sum += x_L[std::size_t(node)];
    points.emplace_back(X_BL * Vec3(sum / double(of_face.size())));
  }
  return points;
}

void ContinuousContactCheck::commit(const contact::RigidObstacle& obstacle,
                                    std::span<const Vec3> x_L) {
  from_B_ = points_B(obstacle, x_L);
}

std::optional<std::string> ContinuousContactCheck::rejection_reason(
    const contact::RigidObstacle& obstacle, std::span<const Vec3> x_L) const {
  constexpr double kCells = 2.0, kMinStep = 0.5;  // Of the resolution of the query.
  const double cell_mm = obstacle.distance_query_B->resolution_mm();
  const contact::RigidObstacle at_origin{.distance_query_B = obstacle.distance_query_B};
  const std::vector<Vec3> to_B = points_B(obstacle, x_L);
  LEFORT_CHECK(from_B_.size() == to_B.size());
  std::vector<double> excess_mm(to_B.size(), 0.0);
  parallel_for(Index(to_B.size()), [&](Index k) {
    const Vec3 &from = from_B_[std::size_t(k)], &to = to_B[std::size_t(k)];
    if ((to - from).norm() <= kCells * cell_mm || gap_mm(at_origin, from) < 0.0) return;
    const double deepest = deepest_mm(at_origin, from, to, kMinStep * cell_mm);
    excess_mm[std::size_t(k)] = deepest - std::max(-gap_mm(at_origin, to), 0.0);
  });
  const auto maximum = std::max_element(excess_mm.begin(), excess_mm.end());
  if (maximum == excess_mm.end() || *maximum <= kCells * cell_mm) return std::nullopt;
  const Vec3 at_L = obstacle.X_LB * to_B[std::size_t(maximum - excess_mm.begin())];
  return fmt::format(
      "a face, now at ({:.3f}, {:.3f}, {:.3f}) mm, passed through {} in one increment", at_L.x(),
      at_L.y(), at_L.z(), name_);
}

}  // namespace lefort::solve
