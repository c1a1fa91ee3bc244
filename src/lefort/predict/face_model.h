/// \file
/// All that is there before anything moves: tissue, and the segments that will move it.
#pragma once

#include <lefort/field/distance_field.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/mesh/volume_mesh.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace lefort::predict {

/// A piece of bone that moves, where it was scanned, and how far points are from it.
struct MovedSegment {
  geometry::TriangleMesh surface_B;
  std::shared_ptr<const field::DistanceField> field_B;
};

struct FaceModel {
  mesh::VolumeMesh tissue;             ///< With the sets of tissue_boundary.h.
  std::vector<MovedSegment> segments;  ///< One or more, in the order of the plan.
  /// Bone that does not move; needed where tissue is painted to slide on it.
  std::optional<MovedSegment> stationary_bone = std::nullopt;
};

/// Which nodes go by which segment: each by the one whose surface is nearest to it at rest, of
/// several equally near by the first.
///
/// \param nodes  of the model's tissue.
/// \returns one list a segment, each in the order of `nodes`.
[[nodiscard]] std::vector<std::vector<std::int32_t>> nodes_by_segment(
    const FaceModel& model, const std::vector<std::int32_t>& nodes);

}  // namespace lefort::predict
