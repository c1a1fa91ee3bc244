#include <lefort/contact/bone_overlap.h>
#include <lefort/contact/measure_gap.h>
#include <lefort/core/check.h>
#include <lefort/core/parallel.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace lefort::contact {
namespace {

/// Vertices, then points on the edges. Each edge is sampled once: by the triangle that has it in
/// the direction of ascending vertex numbers.
std::vector<Vec3> points_of(const SolidBone& bone, double spacing_mm) {
  const geometry::TriangleMesh& mesh = *bone.surface_B;
  std::vector<Vec3> points_L;
  for (const Vec3& v_B : mesh.vertices) points_L.push_back(bone.obstacle.X_LB * v_B);
  for (const geometry::Triangle& t : mesh.triangles)
    for (std::size_t side = 0; side < 3; ++side) {
      if (t[side] > t[(side + 1) % 3]) continue;
      const Vec3 from = points_L[std::size_t(t[side])];
      const Vec3 to = points_L[std::size_t(t[(side + 1) % 3])];
      const int parts = int(std::ceil((to - from).norm() / spacing_mm));
      for (int n = 1; n < parts; ++n) points_L.push_back(from + (double(n) / parts) * (to - from));
    }
  return points_L;
}

/// \returns the depth of each point in the bone; 0 outside.
std::vector<double> depths(const RigidObstacle& bone, std::span<const Vec3> points_L) {
  std::vector<Gap> gaps(points_L.size());
  measure_gaps(bone, points_L, Derivatives::kFirst, gaps);
  std::vector<double> depth_mm(points_L.size(), 0.0);
  for (std::size_t i = 0; i < gaps.size(); ++i) {
    const bool is_known =
        gaps[i].zone == field::Zone::kBand || gaps[i].zone == field::Zone::kInside;
    if (is_known && gaps[i].gap_mm < 0.0) depth_mm[i] = -gaps[i].gap_mm;
  }
  return depth_mm;
}

/// \returns the volume of the part of the box that lies in both bones [mm^3].
double volume_in_both_mm3(const RigidObstacle& a, const RigidObstacle& b, const Box3& box_L) {
  constexpr double kMinSpacing_mm = 0.05;
  constexpr double kPoints = 1e6;  // Of the lattice, approximately.
  const double spacing_mm = std::max(kMinSpacing_mm, std::cbrt(box_L.volume() / kPoints));
  std::array<Index, 3> count{};
  for (int k = 0; k < 3; ++k)
    count[std::size_t(k)] = std::max<Index>(std::lround(box_L.sizes()[k] / spacing_mm), 1);
  const Vec3 step_mm(box_L.sizes().x() / double(count[0]), box_L.sizes().y() / double(count[1]),
                     box_L.sizes().z() / double(count[2]));
  // Row by row, to limit memory.
  const Index inside = deterministic_sum(count[1] * count[2], Index(0), [&](Index row) {
    std::vector<Vec3> points_L;
    for (Index i = 0; i < count[0]; ++i)
      points_L.push_back(box_L.min() +
                         step_mm.cwiseProduct(Vec3(double(i) + 0.5, double(row % count[1]) + 0.5,
                                                   double(row / count[1]) + 0.5)));
    const std::vector<double> in_a = depths(a, points_L), in_b = depths(b, points_L);
    Index both = 0;
    for (std::size_t i = 0; i < points_L.size(); ++i)
      if (in_a[i] > 0.0 && in_b[i] > 0.0) ++both;
    return both;
  });
  return double(inside) * step_mm.prod();
}

}  // namespace

BoneOverlap measure_overlap(const SolidBone& moved, const SolidBone& stationary,
                            double edge_spacing_mm) {
  LEFORT_CHECK(moved.surface_B != nullptr && stationary.surface_B != nullptr &&
               edge_spacing_mm > 0.0);
  BoneOverlap overlap;
  Box3 box_L;
  const auto depths_of = [&](const SolidBone& of, const RigidObstacle& in) {
    const std::vector<Vec3> points_L = points_of(of, edge_spacing_mm);
    std::vector<double> depth_mm = depths(in, points_L);
    for (std::size_t i = 0; i < points_L.size(); ++i) {
      if (!(depth_mm[i] > kTouching_mm)) {
        depth_mm[i] = 0.0;
        continue;
      }
      // The overlap may extend to the neighboring samples.
      box_L.extend(points_L[i] - Vec3::Constant(edge_spacing_mm));
      box_L.extend(points_L[i] + Vec3::Constant(edge_spacing_mm));
      if (depth_mm[i] >= in.distance_query_B->max_distance_mm())
        overlap.depth_is_lower_bound = true;
      if (depth_mm[i] <= overlap.deepest_mm) continue;
      overlap.deepest_mm = depth_mm[i];
      overlap.deepest_L = points_L[i];
    }
    depth_mm.resize(of.surface_B->vertices.size());
    return depth_mm;
  };
  overlap.depth_mm = depths_of(moved, stationary.obstacle);
  overlap.depth_of_second_mm = depths_of(stationary, moved.obstacle);
  if (overlap.overlaps())
    overlap.volume_mm3 = volume_in_both_mm3(moved.obstacle, stationary.obstacle, box_L);
  return overlap;
}

}  // namespace lefort::contact
