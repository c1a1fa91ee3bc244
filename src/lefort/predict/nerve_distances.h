/// \file
/// Distances of osteotomies from the canals of nerves.
#pragma once

#include <lefort/plan/cut_segments.h>

#include <span>
#include <string>
#include <vector>

namespace lefort::predict {

/// The canal of a nerve: a tube around a polyline.
struct NerveTube {
  std::string name;  ///< "right".
  std::vector<Vec3> line_L;
  double radius_mm = 0.0;
};

/// The closest approach of one osteotomy to one canal.
struct NerveDistance {
  std::string segment;  ///< Of the osteotomy.
  std::string nerve;
  /// From the cut face of the segment to the wall of the canal, minus the kerf, which the saw takes
  /// from the bone beside the segment; 0 where the canal is cut.
  double distance_mm;
  Vec3 nerve_L;  ///< The point of the center line.
};

/// \param cut        result of cut_segments().
/// \param planned    the plan that was cut.
/// \param nerves     canals before the movement.
/// \param within_mm  larger distances are not reported.
/// \returns the approaches, in the order of the plan, then of the nerves.
[[nodiscard]] std::vector<NerveDistance> nerve_distances(
    const plan::CutSegments& cut, std::span<const plan::PlannedSegment> planned,
    std::span<const NerveTube> nerves, double within_mm);

/// "the cut of 'distal' passes 1.2 mm from the canal of the right inferior alveolar nerve, at (..);
/// the limit is 2 mm"
[[nodiscard]] std::string describe(const NerveDistance& found, double limit_mm);

}  // namespace lefort::predict
