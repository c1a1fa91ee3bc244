/// \file
/// Distances of osteotomies from teeth and their roots.
#pragma once

#include <lefort/anatomy/find_teeth.h>
#include <lefort/image/volume.h>
#include <lefort/plan/cut_segments.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace lefort::predict {

/// The closest approach of one osteotomy to the teeth of the jaw that it cuts.
struct RootDistance {
  std::string segment;  ///< Of the osteotomy.
  anatomy::Tooth jaw;
  double distance_mm;  ///< From the cut face of the segment to the center of a tooth voxel.
  Vec3 tooth_L;        ///< That center.
  int fdi = 0;         ///< FDI number of that tooth; 0 if it has none.
};

/// \param cut        result of cut_segments().
/// \param planned    the plan that was cut; a known procedure is compared with the teeth of its
///   jaw alone.
/// \param labels     of the scan: cuts in the mandible are compared with lower teeth, all others
///   with upper teeth.
/// \param teeth      crowns and roots. \pre on the grid of `labels`.
/// \param numbers    FDI numbers of the teeth, on the same grid; null: unknown.
/// \param within_mm  larger distances are not reported.
/// \returns the approaches, in the order of the plan, upper teeth first.
[[nodiscard]] std::vector<RootDistance> root_distances(
    const plan::CutSegments& cut, std::span<const plan::PlannedSegment> planned,
    const anatomy::LabelMap& labels, const anatomy::ToothMap& teeth,
    const image::Volume<std::uint8_t>* numbers, double within_mm);

/// "the cut of 'maxilla' passes 1.8 mm from tooth 16, at (0, -60, -30); the limit is 5 mm"
[[nodiscard]] std::string describe(const RootDistance& found, double limit_mm);

}  // namespace lefort::predict
