/// \file
/// Distance queries of the bones of a prediction, and whether contact can rely on them.
#pragma once

#include <lefort/contact/distance_query.h>
#include <lefort/core/error.h>
#include <lefort/geometry/rigid_path.h>
#include <lefort/predict/face_model.h>
#include <lefort/predict/prediction_options.h>

#include <memory>
#include <vector>

namespace lefort::predict {

/// One for each segment, in the order of the plan.
using DistanceQueries = std::vector<std::shared_ptr<const contact::DistanceQuery>>;

/// Distance query of a bone's obstacle, or of the bone itself if it has none. A bounding-volume
/// hierarchy has the same maximum distance as the field: its band.
///
/// \param segment    a segment or the stationary bone.
/// \param detection  the method of the query.
/// \returns as contact::field_distance_query().
[[nodiscard]] Result<std::shared_ptr<const contact::DistanceQuery>> bone_distance_query(
    const ContactBone& segment, contact::DetectionMethod detection);

/// Distance query of the bone that an obstacle replaces, by trilinear interpolation; null if the
/// bone has no obstacle.
[[nodiscard]] Result<std::shared_ptr<const contact::DistanceQuery>> replaced_bone_query(
    const ContactBone& bone);

/// bone_distance_query() of each segment.
[[nodiscard]] Result<DistanceQueries> bone_distance_queries(
    const std::vector<ContactBone>& segments, contact::DetectionMethod detection);

/// Checks that distance queries of the segments suffice for contact along the paths. Checks nothing
/// if tissue is bonded to the segments.
///
/// \param paths               one for each segment.
/// \param segments            in the order of `paths`.
/// \param distance_queries_B  of the segments.
/// \param boundary            its interface and contact snap distance are used.
/// \returns nothing, or
///   - kMeshInvalid      a surface is open: it has no inside;
///   - kInvalidArgument  boundary.contact_snap_mm is not less than a query's maximum distance;
///   - kStepBeyondBand   between two neighbors among the steps and keyframes of all paths, a
///     segment moves by the maximum distance of its query or more.
[[nodiscard]] Result<void> check_query_range(const std::vector<geometry::RigidPath>& paths,
                                             const std::vector<ContactBone>& segments,
                                             const DistanceQueries& distance_queries_B,
                                             const BoundaryOptions& boundary);

/// The same before the queries exist, for those that `detection` would make.
///
/// \param segments  their fields may still lack what a smooth query needs.
[[nodiscard]] Result<void> check_query_range(const std::vector<geometry::RigidPath>& paths,
                                             const std::vector<ContactBone>& segments,
                                             contact::DetectionMethod detection,
                                             const BoundaryOptions& boundary);

/// Checks that a distance query of stationary bone suffices for tissue that slides on it.
///
/// \param distance_query_L  of the stationary bone.
/// \param contact_snap_mm   boundary.contact_snap_mm.
/// \returns nothing, or kMeshInvalid and kInvalidArgument as check_query_range().
[[nodiscard]] Result<void> check_stationary_bone(const contact::DistanceQuery& distance_query_L,
                                                 double contact_snap_mm);

}  // namespace lefort::predict
