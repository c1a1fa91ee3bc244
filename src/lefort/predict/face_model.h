/// \file
/// The face at rest: the tissue mesh and the bones.
#pragma once

#include <lefort/field/distance_field.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/mesh/volume_mesh.h>
#include <lefort/predict/interface_map.h>
#include <lefort/predict/prediction_options.h>
#include <lefort/predict/separate_lips.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace lefort::predict {

/// The body that contact reads in place of a bone (regularized_bone.h).
struct ContactObstacle {
  geometry::TriangleMesh surface_B;
  std::shared_ptr<const field::DistanceField> field_B;
  double p50_distance_mm = 0.0;  ///< RegularizedBone::p50_distance_mm.
  double p99_distance_mm = 0.0;  ///< RegularizedBone::p99_distance_mm.
};

/// A bone that tissue can touch, at its position in the scan: a mobilized segment, or the
/// stationary bone. B is the frame of the bone; for stationary bone it is L.
struct ContactBone {
  geometry::TriangleMesh surface_B;
  std::shared_ptr<const field::DistanceField> field_B;
  std::shared_ptr<const ContactObstacle> obstacle = nullptr;  ///< Null: the bone itself.
};

/// What contact reads: the obstacle of the bone, or the bone itself.
[[nodiscard]] inline const geometry::TriangleMesh& contact_surface_B(const ContactBone& bone) {
  return bone.obstacle ? bone.obstacle->surface_B : bone.surface_B;
}
[[nodiscard]] inline const std::shared_ptr<const field::DistanceField>& contact_field_B(
    const ContactBone& bone) {
  return bone.obstacle ? bone.obstacle->field_B : bone.field_B;
}

struct FaceModel {
  mesh::VolumeMesh tissue;            ///< With the sets of tissue_boundary.h.
  std::vector<ContactBone> segments;  ///< One or more, in the order of the plan.
  /// Needed if tissue on it is sliding or elevated, or if there is a set sets::kStationaryContact.
  std::optional<ContactBone> stationary_bone = std::nullopt;
  /// Conditions of the tissue boundary. Empty: only the sets define conditions.
  InterfaceMap interface = {};
  LipSlit lips = {};
};

/// What contact reads in a model: kRegularized if every segment has an obstacle.
[[nodiscard]] inline Obstacle obstacle_of(const FaceModel& model) {
  return std::all_of(model.segments.begin(), model.segments.end(),
                     [](const ContactBone& segment) { return segment.obstacle != nullptr; })
             ? Obstacle::kRegularized
             : Obstacle::kBone;
}

/// Assigns each node to the segment with the closest surface at rest; of equally close segments, to
/// the first.
///
/// \param model  its tissue and segments are used.
/// \param nodes  of the model's tissue.
/// \returns one list for each segment, each in the order of `nodes`.
[[nodiscard]] std::vector<std::vector<std::int32_t>> nodes_by_segment(
    const FaceModel& model, const std::vector<std::int32_t>& nodes);

/// The nodes that move with each segment.
///
/// \returns one list for each segment: nodes that the interface map bonds to it, or, if the map is
///   empty, those of nodes_with_segment() by nodes_by_segment().
[[nodiscard]] std::vector<std::vector<std::int32_t>> bonded_by_segment(const FaceModel& model,
                                                                       TissueInterface interface);

}  // namespace lefort::predict
