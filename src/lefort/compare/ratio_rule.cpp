#include <lefort/compare/ratio_rule.h>
#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/geometry/bvh.h>

#include <limits>

namespace lefort::compare {

double soft_to_hard_ratio(FaceRegion region) {
  switch (region) {
    case FaceRegion::kChin:
      return 0.95;
    case FaceRegion::kLowerLip:
      return 1.0;
    case FaceRegion::kUpperLip:
      return 0.8;
    case FaceRegion::kNose:
    case FaceRegion::kRightCheek:
    case FaceRegion::kLeftCheek:
      return 0.75;
    case FaceRegion::kElsewhere:
      return 0.0;
  }
  return 0.0;
}

geometry::TriangleMesh apply_ratio_rule(geometry::TriangleMesh skin_L,
                                        std::span<const FaceRegion> region_of,
                                        std::span<const MovedBone> bones) {
  LEFORT_CHECK(region_of.size() == skin_L.vertices.size());
  std::vector<geometry::Bvh> trees;
  for (const MovedBone& bone : bones) trees.emplace_back(*bone.surface_B);
  parallel_for(skin_L.vertex_count(), [&](Index v) {
    const double ratio = soft_to_hard_ratio(region_of[std::size_t(v)]);
    if (ratio == 0.0) return;
    Vec3& p_L = skin_L.vertices[std::size_t(v)];
    double nearest_mm = std::numeric_limits<double>::infinity();
    Vec3 displacement_mm = Vec3::Zero();
    for (std::size_t k = 0; k < trees.size(); ++k) {
      const auto nearest = trees[k].closest_point(p_L, nearest_mm);
      if (!nearest || !(nearest->distance_mm < nearest_mm)) continue;
      nearest_mm = nearest->distance_mm;
      displacement_mm = bones[k].X_LB * p_L - p_L;
    }
    p_L += ratio * displacement_mm;
  });
  return skin_L;
}

}  // namespace lefort::compare
