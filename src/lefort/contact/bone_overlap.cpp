#include <lefort/contact/bone_overlap.h>
#include <lefort/contact/measure_gap.h>
#include <lefort/core/check.h>
#include <lefort/core/parallel.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

namespace lefort::contact {
namespace {

/// Where points of another bone may lie in `bone`, in its frame: the box of its surface, larger by
/// the error of its distance query. All of space if the surface is open.
Box3 box_of(const SolidBone& bone) {
  const DistanceQuery& query_B = *bone.obstacle.distance_query_B;
  if (!query_B.is_closed()) {
    const Vec3 far = Vec3::Constant(std::numeric_limits<double>::infinity());
    return {-far, far};
  }
  Box3 box_B;
  for (const Vec3& v_B : bone.surface_B->vertices) box_B.extend(v_B);
  if (box_B.isEmpty()) return box_B;
  const Vec3 margin = Vec3::Constant(2.0 * query_B.resolution_mm());
  return {box_B.min() - margin, box_B.max() + margin};
}

/// Points of one bone that may lie in another bone.
struct NearPoints {
  std::vector<Vec3> points_L;
  std::vector<std::size_t> vertices;  ///< The vertices among them, which come first.
};

/// Vertices, then points on the edges. Each edge is sampled once: by the triangle that has it in
/// the direction of ascending vertex numbers.
NearPoints points_near(const SolidBone& bone, const SolidBone& other, double spacing_mm) {
  const geometry::TriangleMesh& mesh = *bone.surface_B;
  const Box3 box_O = box_of(other);
  const RigidTransform X_OL = other.obstacle.X_LB.inverse();
  std::vector<Vec3> vertices_L(mesh.vertices.size()), vertices_O(mesh.vertices.size());
  parallel_for(mesh.vertex_count(), [&](Index v) {
    vertices_L[std::size_t(v)] = bone.obstacle.X_LB * mesh.vertices[std::size_t(v)];
    vertices_O[std::size_t(v)] = X_OL * vertices_L[std::size_t(v)];
  });
  NearPoints near;
  for (std::size_t v = 0; v < vertices_L.size(); ++v) {
    if (!box_O.contains(vertices_O[v])) continue;
    near.points_L.push_back(vertices_L[v]);
    near.vertices.push_back(v);
  }
  for (const geometry::Triangle& t : mesh.triangles)
    for (std::size_t side = 0; side < 3; ++side) {
      if (t[side] > t[(side + 1) % 3]) continue;
      const auto a = std::size_t(t[side]), b = std::size_t(t[(side + 1) % 3]);
      Box3 edge_O(vertices_O[a]);
      if (!box_O.intersects(edge_O.extend(vertices_O[b]))) continue;
      const Vec3 &from = vertices_L[a], &to = vertices_L[b];
      const int parts = int(std::ceil((to - from).norm() / spacing_mm));
      for (int n = 1; n < parts; ++n)
        near.points_L.push_back(from + (double(n) / parts) * (to - from));
    }
  return near;
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
  const auto depths_of = [&](const SolidBone& of, const SolidBone& in) {
    const auto [points_L, vertices] = points_near(of, in, edge_spacing_mm);
    const std::vector<double> depth_mm = depths(in.obstacle, points_L);
    std::vector<double> vertex_mm(of.surface_B->vertices.size(), 0.0);
    for (std::size_t i = 0; i < points_L.size(); ++i) {
      if (!(depth_mm[i] > kTouching_mm)) continue;
      if (i < vertices.size()) vertex_mm[vertices[i]] = depth_mm[i];
      // The overlap may extend to the neighboring samples.
      box_L.extend(points_L[i] - Vec3::Constant(edge_spacing_mm));
      box_L.extend(points_L[i] + Vec3::Constant(edge_spacing_mm));
      if (depth_mm[i] >= in.obstacle.distance_query_B->max_distance_mm())
        overlap.depth_is_lower_bound = true;
      if (depth_mm[i] <= overlap.deepest_mm) continue;
      overlap.deepest_mm = depth_mm[i];
      overlap.deepest_L = points_L[i];
    }
    return vertex_mm;
  };
  overlap.depth_mm = depths_of(moved, stationary);
  overlap.depth_of_second_mm = depths_of(stationary, moved);
  if (overlap.overlaps())
    overlap.volume_mm3 = volume_in_both_mm3(moved.obstacle, stationary.obstacle, box_L);
  return overlap;
}

}  // namespace lefort::contact
