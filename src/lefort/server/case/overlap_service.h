/// \file
/// How deep bones lie in each other while they are being dragged.
#pragma once

#include <lefort/contact/rigid_obstacle.h>
#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/geometry/triangle_mesh.h>

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace lefort::server {

/// The poses of segments by name: X_LB, rigid.
using Poses = std::map<std::string, RigidTransform>;

/// The bones of a plan with their fields. Immutable; safe to ask from many threads.
class OverlapService {
 public:
  /// Reads what cut_plan() has made.
  [[nodiscard]] static Result<OverlapService> read(const std::filesystem::path& cut_folder,
                                                   const std::filesystem::path& cache);

  struct Depths {
    std::vector<std::pair<std::string, Index>> segments;  ///< The moved ones, and their vertices.
    std::vector<double> depth_mm;  ///< Of each vertex, one segment after the other; 0 outside.
    double deepest_mm = 0.0;
    bool depth_is_lower_bound = false;  ///< Somewhere deeper than a field can tell.
  };

  /// How deep the vertices of the segments named lie in still bone and in the other segments; a
  /// segment that is not named is where it was scanned. What is no deeper than
  /// contact::kTouching_mm is 0.
  ///
  /// \returns kInvalidArgument that names a segment which there is not.
  [[nodiscard]] Result<Depths> depths(const Poses& poses) const;

 private:
  struct Bone {
    std::string name;  ///< Empty: the bone that stays.
    geometry::TriangleMesh surface_B;
    Box3 box_B;
    std::shared_ptr<const contact::DistanceQuery> distance_query_B;
  };
  std::vector<Bone> bones_;
};

}  // namespace lefort::server
