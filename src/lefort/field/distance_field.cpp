#include <lefort/core/check.h>
#include <lefort/field/distance_field.h>
#include <lefort/field/spline_lattice.h>
#include <lefort/field/trilinear.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace lefort::field {

namespace {

/// Which side a distance tells beyond the band.
Zone side_of(double distance_mm, const FieldFrame& frame) {
  if (!frame.closed) return Zone::kUnknown;
  return distance_mm < 0.0 ? Zone::kInside : Zone::kOutside;
}

double distance_beyond(Zone zone, const FieldFrame& frame) {
  return zone == Zone::kInside ? -frame.band_mm : frame.band_mm;
}

}  // namespace

DistanceField::DistanceField(const FieldFrame& frame, Octree octree, SparseLattice smooth)
    : frame_(frame), octree_(std::move(octree)), smooth_(std::move(smooth)) {
  LEFORT_CHECK(frame_.cell_mm > 0.0 && frame_.band_mm > 0.0);
  LEFORT_CHECK(octree_.resolution() == frame_.resolution);
  LEFORT_CHECK(smooth_.resolution() == frame_.resolution);
}

Box3 DistanceField::box_B() const {
  const Vec3 sides = Vec3::Constant(frame_.cell_mm * frame_.resolution);
  return {frame_.origin_B, frame_.origin_B + sides};
}

std::optional<DistanceField::Located> DistanceField::locate(const Vec3& p_B) const {
  const Vec3 u = (p_B - frame_.origin_B) / frame_.cell_mm;
  const bool in_box = (u.array() >= 0.0).all() && (u.array() <= frame_.resolution).all();
  if (!in_box) return std::nullopt;  // NaN, too.
  LatticePoint cell{};
  for (int k = 0; k < 3; ++k) cell[std::size_t(k)] = std::min(int(u[k]), frame_.resolution - 1);
  return Located{u, octree_.find(cell)};
}

Zone DistanceField::zone_beyond_box(const Vec3& p_B) const {
  return frame_.closed && p_B.allFinite() ? Zone::kOutside : Zone::kUnknown;
}

FieldSample DistanceField::sample(const Vec3& p_B) const {
  const auto beyond = [&](Zone zone) {
    return FieldSample{zone, distance_beyond(zone, frame_), Vec3::Zero()};
  };
  const std::optional<Located> at = locate(p_B);
  if (!at) return beyond(zone_beyond_box(p_B));
  if (at->place.zone != Zone::kBand) return beyond(at->place.zone);

  const OctreeLeaf& leaf = at->place.leaf;
  const Vec3 t = (at->u - Vec3(leaf.low[0], leaf.low[1], leaf.low[2])) / leaf.cells;
  const double distance = trilinear(at->place.corners, t);
  if (std::abs(distance) > frame_.band_mm) return beyond(side_of(distance, frame_));
  return {Zone::kBand, distance,
          trilinear_gradient(at->place.corners, t) / (leaf.cells * frame_.cell_mm)};
}

SmoothSample DistanceField::sample_smooth(const Vec3& p_B) const {
  const auto beyond = [&](Zone zone) {
    return SmoothSample{zone, distance_beyond(zone, frame_), Vec3::Zero(), Mat3::Zero()};
  };
  const std::optional<Located> at = locate(p_B);
  if (!at) return beyond(zone_beyond_box(p_B));
  if (at->place.zone != Zone::kBand) return beyond(at->place.zone);

  const SplineValue spline = evaluate_spline(smooth_, at->u);
  if (std::isnan(spline.value)) return beyond(Zone::kUnknown);  // Next to a tear of the sign.
  if (std::abs(spline.value) > frame_.band_mm) return beyond(side_of(spline.value, frame_));
  return {Zone::kBand, spline.value, spline.gradient / frame_.cell_mm,
          spline.hessian / (frame_.cell_mm * frame_.cell_mm)};
}

FieldStatistics DistanceField::statistics() const {
  return {octree_.node_count() - octree_.count(NodeCode::kBranch), octree_.count(NodeCode::kBand),
          Index(octree_.samples().size()), octree_.bytes(), smooth_.bytes()};
}

}  // namespace lefort::field
