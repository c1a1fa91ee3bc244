/// \file
/// Overlap of bones while a segment is dragged.
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

/// Rigid poses X_LB of segments, by name.
using Poses = std::map<std::string, RigidTransform>;

/// The bones of a plan with their fields. Immutable; thread-safe.
class OverlapService {
 public:
  /// Reads the files of cut_plan().
  ///
  /// \returns the bones; kFileCorrupt if cut.json is damaged; or the errors of io::read_text(),
  ///   io::read_surface() and io::read_field().
  [[nodiscard]] static Result<OverlapService> read(const std::filesystem::path& cut_folder,
                                                   const std::filesystem::path& cache);

  struct Depths {
    std::vector<std::pair<std::string, Index>> segments;  ///< Named segments, number of vertices.
    std::vector<double> depth_mm;  ///< Of each vertex, one segment after the other; 0 outside.
    double deepest_mm = 0.0;
    bool depth_is_lower_bound = false;  ///< A depth exceeds the band of a field.
  };

  /// Depth of the vertices of the named segments in stationary bone and in the other segments. A
  /// segment that is not named has its scanned pose. Depths up to contact::kTouching_mm are 0.
  ///
  /// \returns the depths; kInvalidArgument if a segment does not exist.
  [[nodiscard]] Result<Depths> depths(const Poses& poses) const;

 private:
  struct Bone {
    std::string name;  ///< Empty: the stationary bone.
    geometry::TriangleMesh surface_B;
    Box3 box_B;
    std::shared_ptr<const contact::DistanceQuery> distance_query_B;
  };
  std::vector<Bone> bones_;
};

}  // namespace lefort::server
