/// \file
/// Finds landmarks on the surfaces of a head, by their anatomical definitions.
#pragma once

#include <lefort/core/error.h>
#include <lefort/geometry/symmetry_plane.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/plan/landmarks.h>

#include <string>
#include <vector>

namespace lefort::plan {

/// The surfaces of one head, in L. Null: not segmented, or not in the scan.
struct HeadSurfaces {
  const geometry::TriangleMesh* skull_L = nullptr;     ///< Cranium and maxilla.
  const geometry::TriangleMesh* mandible_L = nullptr;  ///< With its teeth, unless they follow.
  const geometry::TriangleMesh* skin_L = nullptr;
  const geometry::TriangleMesh* upper_teeth_L = nullptr;
  const geometry::TriangleMesh* lower_teeth_L = nullptr;
  double voxel_mm = 1.0;  ///< Largest voxel edge of the scan, > 0.
};

struct FoundLandmark {
  Landmark landmark;
  /// Standard uncertainty: root of the sum of squares of the RMS distance of the points within one
  /// voxel of the extreme value, half a voxel, and the error of the rule (docs/guide/landmarks.md).
  double uncertainty_mm;
};

struct MissingLandmark {
  std::string name;
  std::string reason;  ///< "the scan ends there", "no mandible".
};

/// The result of find_landmarks().
struct LandmarkSearch {
  /// From L to the natural directions F: x to the patient's left, normal to the mid-sagittal plane;
  /// y to posterior, along the Frankfurt horizontal if `has_frankfurt_horizontal`; z to superior.
  /// The mid-sagittal plane is x = 0.
  RigidTransform X_FL = RigidTransform::Identity();
  bool has_frankfurt_horizontal = false;
  geometry::SymmetryPlane mid_sagittal_L;
  std::vector<FoundLandmark> found;
  std::vector<MissingLandmark> missing;  ///< Standard landmarks except S and Ar.

  [[nodiscard]] Landmarks landmarks() const;
};

/// Finds the landmarks of bone, teeth and skin.
///
/// 1. Bone below the mandible, or more than 250 mm below the vertex, is not part of the head.
/// 2. The mid-sagittal plane is the symmetry plane of the skull (fit_symmetry_plane()).
/// 3. The other directions lie in that plane: those of the scan; after a first search, those of the
///    Frankfurt horizontal through Po and Or.
/// 4. Orbits and piriform aperture are the concavities of the skull seen from the front; the
///    pronasale is the most prominent point of the face. They bound the regions of the landmarks.
/// 5. Each landmark is an extremum of a direction, or of the distance from a chord, within its
///    region, by the definitions of three-dimensional cephalometry \cite swennen2006.
///
/// \param head  the surfaces, upright within about 20 degrees of L. \pre the skull is not null.
/// \returns the landmarks; or kAnatomyMissing if the skull has fewer than 100 vertices.
/// \note Same bits for any number of threads.
[[nodiscard]] Result<LandmarkSearch> find_landmarks(const HeadSurfaces& head);

}  // namespace lefort::plan
