/// \file
/// Names the parts of a mesh's boundary: skin, bone segment, cut plane, airway.
#pragma once

#include <lefort/mesh/volume_mesh.h>

#include <functional>
#include <span>
#include <string>

namespace lefort::mesh {

/// A boundary node belongs to `name` if `distance_mm` there is at most `tolerance_mm`; so
/// with a signed distance, points inside do too.
struct BoundaryRule {
  std::string name;
  std::function<double(const Vec3&)> distance_mm;  ///< Of a point in L; called by many threads.
  double tolerance_mm = 0.0;
};

/// Adds a node set and a face set for each rule, and "boundary" for all of the boundary.
///
/// The first rule that takes a node keeps it; nodes taken by none belong to `rest`. A face belongs
/// where most of its nodes do, of several to the earliest rule among them. So the sets
/// share out the boundary: each node and each face is in one of them, and in "boundary".
///
/// \param rules   distinct names, none of them "boundary" or `rest`; sets of a rule that takes
///   nothing are there and empty.
/// \returns `mesh` with the sets added; sets of the same names are replaced.
[[nodiscard]] VolumeMesh name_boundary(VolumeMesh mesh, std::span<const BoundaryRule> rules,
                                       const std::string& rest = "free");

}  // namespace lefort::mesh
