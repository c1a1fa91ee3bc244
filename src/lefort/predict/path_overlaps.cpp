#include <lefort/predict/path_overlaps.h>

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace lefort::predict {

Result<MovingBone> make_moving_bone(std::string name, const geometry::TriangleMesh& surface_B,
                                    const geometry::RigidPath* path,
                                    const std::shared_ptr<const field::DistanceField>& field) {
  LEFORT_TRY(auto distance_query_B,
             contact::field_distance_query(field, contact::DetectionMethod::kTrilinear));
  return MovingBone{std::move(name), &surface_B, path, std::move(distance_query_B),
                    field->cell_mm()};
}

std::vector<BoneOverlapAtFraction> path_overlaps(std::span<const MovingBone> bones, int steps) {
  std::vector<BoneOverlapAtFraction> overlaps;
  for (int step = 1; step <= steps; ++step)
    for (std::size_t a = 0; a < bones.size(); ++a) {
      if (bones[a].path == nullptr) continue;
      for (std::size_t b = a + 1; b < bones.size(); ++b) {
        overlaps.push_back(overlap_at(double(step) / steps, bones[a], bones[b]));
        if (bones[b].path == nullptr) overlaps.back().overlap.depth_of_second_mm = {};
      }
    }
  return overlaps;
}

const BoneOverlapAtFraction* find_deepest(std::span<const BoneOverlapAtFraction> overlaps) {
  const auto deepest =
      std::max_element(overlaps.begin(), overlaps.end(),
                       [](const BoneOverlapAtFraction& a, const BoneOverlapAtFraction& b) {
                         return a.overlap.deepest_mm < b.overlap.deepest_mm;
                       });
  return deepest != overlaps.end() && deepest->overlap.overlaps() ? &*deepest : nullptr;
}

std::string describe_overlap(const BoneOverlapAtFraction& overlap, std::size_t segment_count) {
  const contact::BoneOverlap& common = overlap.overlap;
  const auto bone_name = [&](const std::string& bone) {
    if (bone == kRemainder) return std::string("the stationary bone");
    return segment_count == 1 ? std::string("the segment") : "segment " + bone;
  };
  return fmt::format(
      "bones overlap along the path: at {:.1f} % {} and {} overlap by {:.2f} ml, "
      "{}{:.2f} mm deep at ({:.1f}, {:.1f}, {:.1f}) mm",
      100.0 * overlap.path_fraction, bone_name(overlap.first), bone_name(overlap.second),
      common.volume_mm3 * 1e-3, common.depth_is_lower_bound ? "more than " : "up to ",
      common.deepest_mm, common.deepest_L.x(), common.deepest_L.y(), common.deepest_L.z());
}

}  // namespace lefort::predict
