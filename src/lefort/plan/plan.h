/// \file
/// What the surgeon wants: bone cuts, and the way each cut piece moves. A value.
#pragma once

#include <lefort/core/types.h>

#include <string>
#include <vector>

namespace lefort::plan {

/// A plane that bounds a segment: the segment lies on the side the normal points to.
struct CutPlane {
  Vec3 point_L;   ///< Any point of the plane [mm].
  Vec3 normal_L;  ///< Towards the segment; unit length.
};

/// Frees the bone on the inner side of every plane, for example the mid-face in front of a coronal
/// plane and below an axial one.
struct Osteotomy {
  std::string segment;  ///< The name of the piece it frees.
  std::vector<CutPlane> planes;
};

/// Where the segment is at one moment: rotated about `centre_L`, then translated.
struct Keyframe {
  double at = 1.0;                     ///< Share of the path that is done, 0 to 1.
  Vec3 translation_mm = Vec3::Zero();  ///< In L.
  Vec3 rotation_rad = Vec3::Zero();    ///< Rotation vector (axis times angle) in L.
  Vec3 centre_L = Vec3::Zero();        ///< Fixed point of the rotation [mm].
};

/// What a bone does between two keyframes, while it turns steadily.
enum class Interpolation {
  kStraight,  ///< The later keyframe's centre moves along a straight line.
  kScrew,     ///< The bone turns about one axis and glides along it; no centre takes part.
};

/// The way of one segment, from rest at `at` = 0 through its keyframes.
struct BonePath {
  std::string segment;
  std::vector<Keyframe> keyframes;  ///< Ascending `at`; the last is at 1.
  int steps = 12;                   ///< Equilibria asked for along the way.
  Interpolation interpolation = Interpolation::kStraight;
};

}  // namespace lefort::plan
