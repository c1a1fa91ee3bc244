/// \file
/// The canal of the inferior alveolar nerve, from the mandibular to the mental foramen.
#pragma once

#include <lefort/anatomy/label_map.h>
#include <lefort/core/error.h>
#include <lefort/image/volume.h>

#include <optional>
#include <vector>

namespace lefort::anatomy {

/// What is known of one side of the mandible, in frame L [mm].
struct MandibleSide {
  Vec3 lateral_L;                                           ///< Unit vector to the side.
  Vec3 anterior_L;                                          ///< Unit vector.
  Vec3 superior_L;                                          ///< Unit vector, perpendicular to both.
  Vec3 pogonion_L;                                          ///< Landmark Pg, on the symphysis.
  Vec3 gonion_L;                                            ///< Landmark Go of the side.
  Vec3 condylion_L;                                         ///< Landmark Co of the side.
  std::optional<Vec3> mandibular_foramen_L = std::nullopt;  ///< Given by the user.
  std::optional<Vec3> mental_foramen_L = std::nullopt;      ///< Given by the user.
  std::vector<Vec3> points_L{};  ///< Given by the user: on the canal, from posterior to anterior.
};

struct NerveCanal {
  std::vector<Vec3> line_L;  ///< Center line from posterior to anterior, 0.5 mm between points.
  std::vector<double> hu;    ///< Smoothed CT number at each point.
  /// Fraction of the points that are less dense than the bone around them, at 3 mm: the canal is
  /// visible there.
  double visible_fraction = 0.0;
};

/// Finds the canal as a minimal path through the mandible between the medial surface of the ramus
/// and the lateral surface of the body. As by \cite kainmueller2009 the canal is a dark tube whose
/// course is known roughly, here from landmarks and published means instead of a shape model.
///
/// The speed of the front is a product of three factors:
///   - bone:     1 / (1 + ((h - l) / (0.35 (u - l)))^4) for a smoothed CT number h above l, the
///     10th percentile 2 mm below the surface; u is the median at the surface. Below -120 HU
///     (streaks beside metal), the same with (-120 - h) / 80;
///   - darkness: 0.05 + 0.95 min(1, r / (0.5 (u - l))) with the response r to dark lines of
///     \cite sato1998, sigma 1 mm;
///   - course:   0.05 + 0.95 exp(-d^2 / (2 s^2)) with s = 4 mm and the distance d from the expected
///     course.
///
/// The expected course is
///   - in the ramus, 0.4 of the way from gonion to condylion, 3 mm behind the middle between its
///     anterior and posterior border (Alkohlani et al., 165 scans), on its medial surface;
///   - in the body, 8 to 9 mm above the lower border, in the middle of the bone;
///   - at the mental foramen, 27 mm from the symphysis and 14 mm above the lower border, on its
///     lateral surface (28.8 and 14.9 mm by \cite apinhasmit2006, 26 and 13 mm by others).
///
/// The path may start and end within 7 mm of the expected foramina, on the surface, at a cost that
/// grows with the distance from them. It passes given points and foramina, moved to the closest
/// voxel of the bone and smoothed: within about 1 mm if they lie in the bone. The constants were
/// chosen on the labeled jaws of `script/check_nerve`.
///
/// \param ct      the scan.
/// \param labels  with the mandible. \pre on the grid of `ct`.
/// \param side    landmarks and directions.
/// \returns the canal; or kAnatomyMissing if the mandible has no bone where the course is expected,
///   a given point is more than 3 mm from the mandible, or the landmarks are more than 200 mm from
///   each other.
[[nodiscard]] Result<NerveCanal> trace_nerve(const image::CtVolume& ct, const LabelMap& labels,
                                             const MandibleSide& side);

}  // namespace lefort::anatomy
