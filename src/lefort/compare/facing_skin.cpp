#include <lefort/compare/displacement_at.h>
#include <lefort/compare/facing_skin.h>

#include <optional>

namespace lefort::compare {
namespace {

constexpr double kMinCosine = 0.5;   // Of 60 degrees.
constexpr double kReach_mm = 40.0;   // Thickness of the tissue at most.
constexpr double kOffset_mm = 0.01;  // Between a ray's start and the surface it starts from.

/// Twice the area times the normal.
Vec3 area_vector(const geometry::TriangleMesh& mesh, Index triangle) {
  return (mesh.corner(triangle, 1) - mesh.corner(triangle, 0))
      .cross(mesh.corner(triangle, 2) - mesh.corner(triangle, 0));
}

/// A point of the skin.
struct Exit {
  Index triangle;
  Vec3 point_L;
};

/// Where a ray leaves the head for the last time within reach.
std::optional<Exit> last_exit(const geometry::Bvh& skin, const Vec3& origin_L,
                              const Vec3& direction_L) {
  std::optional<Exit> last;
  double at_mm = 0.0;
  while (const auto hit = skin.first_hit(origin_L + at_mm * direction_L, direction_L)) {
    at_mm += hit->distance_mm;
    if (at_mm > kReach_mm) break;
    if (area_vector(skin.mesh(), hit->triangle).dot(direction_L) > 0.0)
      last = Exit{hit->triangle, origin_L + at_mm * direction_L};
    at_mm += kOffset_mm;
  }
  return last;
}

}  // namespace

FacingMovement facing_movement(const geometry::TriangleMesh& segment_L, const RigidTransform& X_LB,
                               const geometry::Bvh& skin_L, std::span<const Vec3> displacement_mm,
                               const Vec3& anterior_L) {
  const geometry::Bvh segment(segment_L);
  FacingMovement sum;
  for (Index t = 0; t < segment_L.triangle_count(); ++t) {
    const Vec3 normal = area_vector(segment_L, t);
    const double projected_mm2 = 0.5 * normal.dot(anterior_L);
    if (!(projected_mm2 > 0.0) || 2.0 * projected_mm2 < kMinCosine * normal.norm()) continue;
    const Vec3 center_L =
        (segment_L.corner(t, 0) + segment_L.corner(t, 1) + segment_L.corner(t, 2)) / 3.0;
    const Vec3 origin_L = center_L + kOffset_mm * anterior_L;
    if (segment.first_hit(origin_L, anterior_L)) continue;
    const auto exit = last_exit(skin_L, origin_L, anterior_L);
    if (!exit) continue;
    sum.area_mm2 += projected_mm2;
    sum.bone_mm += projected_mm2 * (X_LB * center_L - center_L);
    sum.skin_mm += projected_mm2 *
                   displacement_at(skin_L.mesh(), exit->triangle, exit->point_L, displacement_mm);
    sum.center_L += projected_mm2 * center_L;
  }
  if (!(sum.area_mm2 > 0.0)) return {};
  for (Vec3* const mean : {&sum.bone_mm, &sum.skin_mm, &sum.center_L}) *mean /= sum.area_mm2;
  return sum;
}

}  // namespace lefort::compare
