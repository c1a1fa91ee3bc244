#include <lefort/geometry/bvh.h>
#include <lefort/plan/bones_of_landmarks.h>

namespace lefort::plan {
namespace {

constexpr double kOnBone_mm = 5.0;  // Largest distance of a picked landmark from bone.
constexpr double kOnCut_mm = 0.5;   // Equally close: half the accuracy of picking.

}  // namespace

std::vector<std::optional<std::size_t>> bones_of_landmarks(std::span<const Landmark> landmarks_L,
                                                           const CutSegments& cut) {
  std::vector<std::optional<std::size_t>> bones(landmarks_L.size());
  if (landmarks_L.empty()) return bones;
  std::vector<geometry::Bvh> trees;
  for (const geometry::TriangleMesh& segment : cut.segments_L) trees.emplace_back(segment);
  trees.emplace_back(cut.remainder_L);
  for (std::size_t n = 0; n < landmarks_L.size(); ++n) {
    const LandmarkKind* const kind = landmark_definition(landmarks_L[n].name);
    if (kind != nullptr && kind->is_soft) continue;
    double nearest_mm = kOnBone_mm;
    for (std::size_t k = 0; k < trees.size(); ++k) {
      const auto on_bone = trees[k].closest_point(landmarks_L[n].point_L, kOnBone_mm);
      if (!on_bone || !(on_bone->distance_mm < nearest_mm - (bones[n] ? kOnCut_mm : 0.0))) continue;
      nearest_mm = on_bone->distance_mm;
      bones[n] = k;
    }
  }
  return bones;
}

}  // namespace lefort::plan
