#include <lefort/geometry/rigid_path.h>
#include <lefort/predict/bone_pairs.h>

#include <algorithm>

namespace lefort::predict {

RigidTransform PathBone::pose_at(double share) const {
  return path == nullptr ? RigidTransform::Identity() : geometry::pose_at(*path, share);
}

BonePair overlap_at(double share, const PathBone& first, const PathBone& second) {
  const contact::SolidBone a{first.surface_B, {first.detector_B, first.pose_at(share)}};
  const contact::SolidBone b{second.surface_B, {second.detector_B, second.pose_at(share)}};
  return {first.name, second.name, share,
          contact::measure_overlap(a, b, std::min(first.cell_mm, second.cell_mm))};
}

}  // namespace lefort::predict
