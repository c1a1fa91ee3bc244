/// \file
/// The obstacle that contact reads in place of a bone: the bone at the resolution of the tissue
/// mesh.
///
/// Walls and edges of bone are finer than the faces of the tissue. A face cannot follow them: it
/// snaps from one side of them to the other, and Newton's method with it. The obstacle has no
/// feature below the node spacing h:
///
/// 1. On a lattice of spacing h / 4, with the distances d_B of the bone and d_T of the tissue at
///    rest, a point is inside if d_B < 0. A point at the back of a wall or behind it (d_B < 1.5 h,
///    d_T > d_B, both gradients within 60 degrees) is inside, too: walls are at least 1.5 h thick,
///    away from the tissue.
/// 2. Points in the tissue at rest are outside, so that the rest gap does not depend on the chord
///    height of the faces, and points with d_T > reach are outside.
/// 3. The level set is smoothed by a Gaussian of sigma = 3/4 h. The zero level of a smoothed
///    indicator moves by its mean curvature for the time sigma^2 / 2 (\cite merriman1992): planes
///    stay, features below sigma vanish, and a right angle gets the radius h.
///
/// A cut would become a groove, since each of its sides has edges. If the sides stay together on
/// the path, tissue never reaches these edges: the obstacle of a bone then also has the part of the
/// adjacent bone within a collar around it. The collar narrows to zero as the sides separate by h.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/core/types.h>
#include <lefort/field/distance_field.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/mesh/volume_mesh.h>
#include <lefort/predict/face_model.h>

#include <memory>
#include <span>

namespace lefort::predict {

struct RegularizationOptions {
  double node_spacing_mm = 0.0;  ///< h of the tissue mesh, > 0.
  /// Bone further than this from the tissue, or than 0.4 of the longest side of the tissue's box,
  /// is left out; > h.
  double reach_mm = 0.0;
};

/// Another bone of the model.
struct AdjacentBone {
  std::shared_ptr<const field::DistanceField> field_L;
  double collar_mm = 0.0;  ///< Width of its part of the obstacle; of collar_mm().
};

/// Width of the collar of an adjacent bone.
///
/// \param separation_mm  largest relative motion of the two bones where they adjoin, >= 0.
/// \returns 3/2 (h - separation_mm), but at least 0 [mm].
[[nodiscard]] double collar_mm(double node_spacing_mm, double separation_mm);

/// The tissue at rest, as regularize_bone() needs it.
struct TissueAtRest {
  Box3 box_L;
  field::DistanceField field_L;  ///< Near its boundary, at the spacing of the lattice.
  field::DistanceField far_L;    ///< Up to the reach, at a coarser spacing.
};

/// \param tissue    at rest.
/// \param options   \pre in the ranges above.
/// \param progress  may cancel.
/// \returns the errors of field::build_distance_field().
[[nodiscard]] Result<TissueAtRest> tissue_at_rest(const mesh::VolumeMesh& tissue,
                                                  const RegularizationOptions& options,
                                                  Progress& progress = Progress::none());

/// The regularized bone, and its distance from the bone where it faces tissue.
struct RegularizedBone {
  geometry::TriangleMesh surface_L;  ///< Closed, counter-clockwise seen from outside.
  /// Percentiles of the distance to the bone, over the vertices closer than h / 2 to the tissue at
  /// rest [mm]; 0 if there are none.
  double p50_distance_mm = 0.0;
  double p99_distance_mm = 0.0;
};

/// \param bone      its surface and field are used; B is L.
/// \param adjacent  the other bones of the model.
/// \param tissue    of tissue_at_rest() with the same options.
/// \param options   \pre in the ranges above.
/// \param progress  may cancel.
/// \returns the obstacle, or
///   - kMeshInvalid  nothing is left: the bone is smaller than the mesh can resolve, or further
///     from the tissue than the reach;
///   - kCancelled    `progress` requested a stop.
[[nodiscard]] Result<RegularizedBone> regularize_bone(const ContactBone& bone,
                                                      std::span<const AdjacentBone> adjacent,
                                                      const TissueAtRest& tissue,
                                                      const RegularizationOptions& options,
                                                      Progress& progress = Progress::none());

}  // namespace lefort::predict
