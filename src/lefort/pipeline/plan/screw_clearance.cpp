#include <lefort/anatomy/minimal_path.h>
#include <lefort/pipeline/plan/screw_clearance.h>

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace lefort::pipeline {
namespace {

double distance_to_segment(const Vec3& p, const Vec3& from, const Vec3& to) {
  const Vec3 along = to - from;
  const double t = std::clamp((p - from).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (p - from - t * along).norm();
}

}  // namespace

ScrewClearance::ScrewClearance(const anatomy::ToothMap& teeth, const dental::NumberedTeeth* numbers,
                               std::span<const predict::NerveTube> nerves, const Box3& box_L) {
  constexpr double kReach_mm = 15.0, kLine_mm = 0.5;
  half_voxel_mm_ = 0.5 * teeth.grid.spacing_mm.norm();
  for (std::size_t v = 0; v < teeth.values.size(); ++v) {
    if (teeth.values[v] == anatomy::Tooth::kNone) continue;
    const Vec3 center_L = teeth.grid.center_L(Index(v));
    if (box_L.exteriorDistance(center_L) > kReach_mm) continue;
    teeth_.push_back({center_L, numbers != nullptr ? int(numbers->numbers.values[v]) : 0});
  }
  for (const predict::NerveTube& nerve : nerves)
    nerves_.push_back(
        {nerve.name, anatomy::smoothed_path(nerve.line_L, 0.0, kLine_mm), nerve.radius_mm});
}

ScrewNeighbor ScrewClearance::closest(const Vec3& from_L, const Vec3& to_L) const {
  ScrewNeighbor found{std::numeric_limits<double>::infinity(), ""};
  const ToothPoint* tooth = nullptr;
  for (const ToothPoint& one : teeth_)
    if (const double d = distance_to_segment(one.center_L, from_L, to_L); d < found.distance_mm) {
      found.distance_mm = d;
      tooth = &one;
    }
  if (tooth != nullptr) {
    found.distance_mm = std::max(0.0, found.distance_mm - half_voxel_mm_);
    found.name = tooth->fdi > 0 ? fmt::format("tooth {}", tooth->fdi) : std::string("a tooth");
  }
  for (const predict::NerveTube& nerve : nerves_)
    for (const Vec3& p_L : nerve.line_L)
      if (const double d = distance_to_segment(p_L, from_L, to_L) - nerve.radius_mm;
          d < found.distance_mm)
        found = {std::max(0.0, d), nerve.name + " canal"};
  return found;
}

}  // namespace lefort::pipeline
