#include <lefort/anatomy/minimal_path.h>
#include <lefort/geometry/bvh.h>
#include <lefort/plan/elevation_zone.h>
#include <lefort/predict/nerve_distances.h>

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>

namespace lefort::predict {
namespace {

constexpr double kNerveSpacing_mm = 0.5;

}  // namespace

std::vector<NerveDistance> nerve_distances(const plan::CutSegments& cut,
                                           std::span<const plan::PlannedSegment> planned,
                                           std::span<const NerveTube> nerves, double within_mm) {
  // With the faces of segments that were later cut from the segment.
  auto zones = plan::elevation_zones(cut, planned, std::nullopt);
  std::vector<NerveDistance> found;
  for (std::size_t k = 0; k < planned.size(); ++k) {
    if (zones[k].cut_faces_L.triangles.empty()) continue;
    const geometry::Bvh faces(std::move(zones[k].cut_faces_L));
    for (const NerveTube& nerve : nerves) {
      std::optional<NerveDistance> closest;
      const double inside_mm = nerve.radius_mm + planned[k].osteotomy.kerf_mm;
      for (const Vec3& p_L : anatomy::smoothed_path(nerve.line_L, 0.0, kNerveSpacing_mm)) {
        const auto face = faces.closest_point(p_L, within_mm + inside_mm);
        if (!face) continue;
        const double distance_mm = std::max(0.0, face->distance_mm - inside_mm);
        if (!closest || distance_mm < closest->distance_mm)
          closest = {planned[k].osteotomy.segment, nerve.name, distance_mm, p_L};
      }
      if (closest) found.push_back(*closest);
    }
  }
  return found;
}

std::string describe(const NerveDistance& found, double limit_mm) {
  const std::string where = fmt::format(
      "the canal of the {} inferior alveolar nerve, at ({:.0f}, "
      "{:.0f}, {:.0f}); the limit is {:g} mm",
      found.nerve, found.nerve_L.x(), found.nerve_L.y(), found.nerve_L.z(), limit_mm);
  if (found.distance_mm == 0.0)
    return fmt::format("the cut of '{}' enters {}", found.segment, where);
  return fmt::format("the cut of '{}' passes {:.1f} mm from {}", found.segment, found.distance_mm,
                     where);
}

}  // namespace lefort::predict
