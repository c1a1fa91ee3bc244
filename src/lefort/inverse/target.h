/// \file
/// A target face: where landmarks, the profile or the surface of the skin should be.
#pragma once

#include <lefort/core/types.h>
#include <lefort/geometry/triangle_mesh.h>

#include <optional>
#include <string>
#include <vector>

namespace lefort::inverse {

/// A landmark of the skin moves to a point, or a distance along a direction.
struct LandmarkTarget {
  std::string name;
  Vec3 point_L = Vec3::Zero();  ///< Before surgery; the closest point of the skin is taken.
  Vec3 to_L = Vec3::Zero();     ///< Wanted position [mm].
  /// Only this component of the position is wanted; unit length. Empty: all three.
  std::optional<Vec3> direction_L = std::nullopt;
  double weight = 1.0;  ///< w >= 0.
};

/// The profile at one height: y of the most anterior skin in the plane of the profile.
struct ProfilePoint {
  double z_mm = 0.0;  ///< Height in L.
  double y_mm = 0.0;  ///< Wanted position; anterior is negative.
};

/// The profile in the sagittal plane x = x_mm.
struct ProfileTarget {
  std::string name;
  double x_mm = 0.0;
  std::vector<ProfilePoint> points;
  double weight = 1.0;  ///< w >= 0.
};

/// The skin lies on a surface. Vertices in the box count, weighted by their area, if the surface is
/// closer than max_distance_mm.
struct SurfaceTarget {
  std::string name;
  geometry::TriangleMesh surface_L;
  std::optional<Box3> region_L = std::nullopt;  ///< Empty: all skin that tissue of the mesh moves.
  double max_distance_mm = 15.0;
  double weight = 1.0;  ///< w >= 0.
};

/// The objective is 1/2 sum_k w_k (mean square of the residuals of target k) [mm^2].
struct FaceTarget {
  std::vector<LandmarkTarget> landmarks;
  std::vector<ProfileTarget> profiles;
  std::vector<SurfaceTarget> surfaces;

  [[nodiscard]] std::size_t count() const {
    return landmarks.size() + profiles.size() + surfaces.size();
  }
  /// Landmarks first, then profiles, then surfaces.
  [[nodiscard]] const std::string& name(std::size_t target) const {
    if (target < landmarks.size()) return landmarks[target].name;
    target -= landmarks.size();
    return target < profiles.size() ? profiles[target].name
                                    : surfaces[target - profiles.size()].name;
  }
  /// w of a target, in the same order.
  [[nodiscard]] double weight(std::size_t target) const {
    if (target < landmarks.size()) return landmarks[target].weight;
    target -= landmarks.size();
    return target < profiles.size() ? profiles[target].weight
                                    : surfaces[target - profiles.size()].weight;
  }
};

}  // namespace lefort::inverse
