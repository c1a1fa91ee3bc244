#include <lefort/compare/recover_surgery.h>

#include <utility>

namespace lefort::compare {
namespace {

/// Distance beyond which saw, plates and healing leave bone unaltered.
constexpr double kUnaltered_mm = 10.0;
/// Distance from a cut face within which a segment is not compared: cut faces are planes of the
/// plan, but in a scan they are rounded, worn, or grown over.
constexpr double kCutFace_mm = 2.0;

}  // namespace

Result<Registration> register_remainder(const PlannedBones& bones,
                                        const geometry::TriangleMesh& skull_after,
                                        Progress& progress) {
  return register_surface(unaltered_region(bones.remainder_L, bones.segments_B, kUnaltered_mm),
                          geometry::Bvh(skull_after),
                          initial_alignments(bones.remainder_L, skull_after), {}, progress);
}

Result<std::vector<AchievedMovement>> recover_movements(const PlannedBones& bones,
                                                        const geometry::TriangleMesh& after_L,
                                                        Progress& progress) {
  const geometry::Bvh tree_L(after_L);
  std::vector<AchievedMovement> movements;
  for (std::size_t k = 0; k < bones.segments_B.size(); ++k) {
    const geometry::TriangleMesh& segment_B = bones.segments_B[k];
    const RigidTransform& planned_LB = bones.planned_LB[k];
    std::vector<geometry::TriangleMesh> others_L{bones.remainder_L};
    for (std::size_t other = 0; other < bones.segments_B.size(); ++other)
      if (other != k) others_L.push_back(bones.segments_B[other]);
    LEFORT_TRY(Registration achieved,
               register_segment(unaltered_region(segment_B, others_L, kCutFace_mm + bones.kerf_mm),
                                tree_L, planned_LB, progress));
    movements.push_back({bones.segments[k], planned_LB, achieved,
                         difference_of(RigidTransform::Identity(), achieved.X_onto_from, segment_B),
                         difference_of(planned_LB, achieved.X_onto_from, segment_B)});
  }
  return movements;
}

}  // namespace lefort::compare
