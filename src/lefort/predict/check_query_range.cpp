#include <lefort/core/check.h>
#include <lefort/geometry/bvh.h>
#include <lefort/predict/check_query_range.h>
#include <lefort/predict/load_levels.h>

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace lefort::predict {
namespace {

/// Of a distance query.
struct QueryRange {
  double max_distance_mm;
  bool is_closed;  ///< Its surface.
};

/// Of one segment, see check_query_range().
Result<void> check_query_range_of(const geometry::RigidPath& path,
                                  const std::vector<LoadLevel>& levels, const ContactBone& segment,
                                  const QueryRange& range, double contact_snap_mm) {
  const double band_mm = range.max_distance_mm;
  if (!range.is_closed)
    return fail(
        ErrorCode::kMeshInvalid,
        fmt::format("segment {} is an open surface; contact needs a closed one", path.segment));
  if (!(contact_snap_mm < band_mm))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("boundary.contact_snap_mm is {:g} mm; it must be less than the maximum "
                            "distance of the segment's distance query, {:.2f} mm",
                            contact_snap_mm, band_mm));
  double longest_mm = 0.0, mm_per_fraction = 0.0, from = 0.0;
  for (const LoadLevel& level : levels) {
    const double moved_mm =
        geometry::max_displacement_mm(path, segment.surface_B.vertices, from, level.path_fraction);
    longest_mm = std::max(longest_mm, moved_mm);
    mm_per_fraction = std::max(mm_per_fraction, moved_mm / (level.path_fraction - from));
    from = level.path_fraction;
  }
  if (longest_mm < band_mm) return {};
  return fail(ErrorCode::kStepBeyondBand,
              fmt::format("segment {} moves {:.2f} mm in one step, but the maximum distance of its "
                          "distance query is {:.2f} mm; use at least {} steps or a wider "
                          "field.band_mm",
                          path.segment, longest_mm, band_mm, int(mm_per_fraction / band_mm) + 1));
}

}  // namespace

Result<std::shared_ptr<const contact::DistanceQuery>> bone_distance_query(
    const ContactBone& segment, contact::DetectionMethod detection) {
  const geometry::TriangleMesh& surface_B = contact_surface_B(segment);
  const auto& field_B = contact_field_B(segment);
  if (detection != contact::DetectionMethod::kBvh)
    return contact::field_distance_query(field_B, detection,
                                         std::make_shared<const geometry::TriangleMesh>(surface_B));
  return contact::bvh_distance_query(std::make_shared<const geometry::Bvh>(surface_B),
                                     field_B->band_mm());
}

Result<std::shared_ptr<const contact::DistanceQuery>> replaced_bone_query(const ContactBone& bone) {
  if (!bone.obstacle) return nullptr;
  return contact::field_distance_query(bone.field_B, contact::DetectionMethod::kTrilinear);
}

Result<DistanceQueries> bone_distance_queries(const std::vector<ContactBone>& segments,
                                              contact::DetectionMethod detection) {
  DistanceQueries distance_queries_B;
  for (const ContactBone& segment : segments) {
    LEFORT_TRY(auto distance_query_B, bone_distance_query(segment, detection));
    distance_queries_B.push_back(std::move(distance_query_B));
  }
  return distance_queries_B;
}

Result<void> check_query_range(const std::vector<geometry::RigidPath>& paths,
                               const std::vector<ContactBone>& segments,
                               const DistanceQueries& distance_queries_B,
                               const BoundaryOptions& boundary) {
  if (boundary.interface == TissueInterface::kBonded) return {};
  const std::vector<LoadLevel> levels = load_levels(paths, 1);
  for (std::size_t k = 0; k < paths.size(); ++k)
    LEFORT_TRY_VOID(check_query_range_of(
        paths[k], levels, segments[k],
        {distance_queries_B[k]->max_distance_mm(), distance_queries_B[k]->is_closed()},
        boundary.contact_snap_mm));
  return {};
}

Result<void> check_query_range(const std::vector<geometry::RigidPath>& paths,
                               const std::vector<ContactBone>& segments,
                               contact::DetectionMethod detection,
                               const BoundaryOptions& boundary) {
  LEFORT_CHECK(paths.size() == segments.size());
  if (boundary.interface == TissueInterface::kBonded) return {};
  const std::vector<LoadLevel> levels = load_levels(paths, 1);
  for (std::size_t k = 0; k < paths.size(); ++k) {
    const field::DistanceField& field_B = *contact_field_B(segments[k]);
    const double max_mm = detection == contact::DetectionMethod::kTrilinear
                              ? field_B.guaranteed_mm()
                              : field_B.band_mm();
    LEFORT_TRY_VOID(check_query_range_of(
        paths[k], levels, segments[k], {max_mm, field_B.frame().closed}, boundary.contact_snap_mm));
  }
  return {};
}

Result<void> check_stationary_bone(const contact::DistanceQuery& distance_query_L,
                                   double contact_snap_mm) {
  if (!distance_query_L.is_closed())
    return fail(ErrorCode::kMeshInvalid,
                "the stationary bone is an open surface; tissue that slides on it needs a closed "
                "one");
  if (contact_snap_mm < distance_query_L.max_distance_mm()) return {};
  return fail(ErrorCode::kInvalidArgument,
              fmt::format("boundary.contact_snap_mm is {:g} mm; it must be less than the maximum "
                          "distance of the stationary bone's distance query, {:.2f} mm",
                          contact_snap_mm, distance_query_L.max_distance_mm()));
}

}  // namespace lefort::predict
