/// \file
/// Chooses the holes of a cutting guide.
#pragma once

#include <lefort/dental/cutting_guide.h>

#include <functional>
#include <vector>

namespace lefort::dental {

struct HoleOptions {
  double diameter_mm = 1.5;   ///< Of the drill; 1 to 4.
  double screw_mm = 2.0;      ///< Diameter of the screws; that of the drill to 4.
  double depth_mm = 6.0;      ///< Of the screw in the bone; 2 to 20.
  double from_cut_mm = 5.0;   ///< Distance of the centers from the cut; 3 to 15.
  double min_clear_mm = 2.0;  ///< From roots and nerves; 0 to 10.
};

/// \returns the distance of the axis of a screw, from its entry to its tip, from what it must not
///   touch [mm]; infinity if that is far, negative if no screw may be there.
using ClearOf = std::function<double(const Vec3& from_L, const Vec3& to_L)>;

/// Chooses two holes on each side of the cut, three along more than 30 mm: those points of the bone
/// closest to the wanted distance from the cut and to a fifth, a half and four fifths of the line,
/// which the guide covers, whose surface faces outward, where the bone is 1 mm thick or more, and
/// whose screws are clear.
///
/// \param clear_of  of roots, nerves and the cut.
/// \returns the holes, those on the segment first. Fewer if there is no such point.
[[nodiscard]] std::vector<GuideHole> choose_holes(const GuideSite& site, const CutLine& line,
                                                  const GuideOptions& guide,
                                                  const HoleOptions& options,
                                                  const ClearOf& clear_of);

/// \returns nothing, or kInvalidArgument if an option is out of range.
[[nodiscard]] Result<void> check_holes(const HoleOptions& options, const GuideOptions& guide);

/// \returns how many holes choose_holes() looks for on each side.
[[nodiscard]] int holes_per_side(const CutLine& line);

}  // namespace lefort::dental
