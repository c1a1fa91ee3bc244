#include <lefort/geometry/rigid_path.h>
#include <lefort/predict/bone_overlap_at_fraction.h>

#include <algorithm>

namespace lefort::predict {

RigidTransform MovingBone::pose_at(double path_fraction) const {
  return path == nullptr ? RigidTransform::Identity() : geometry::pose_at(*path, path_fraction);
}

BoneOverlapAtFraction overlap_at(double path_fraction, const MovingBone& first,
                                 const MovingBone& second) {
  const contact::SolidBone a{first.surface_B,
                             {first.distance_query_B, first.pose_at(path_fraction)}};
  const contact::SolidBone b{second.surface_B,
                             {second.distance_query_B, second.pose_at(path_fraction)}};
  return {first.name, second.name, path_fraction,
          contact::measure_overlap(a, b, std::min(first.cell_mm, second.cell_mm))};
}

}  // namespace lefort::predict
