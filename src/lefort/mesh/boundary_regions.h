/// \file
/// Divides the boundary of a mesh into named regions: skin, bone segment, cut plane, airway.
#pragma once

#include <lefort/mesh/volume_mesh.h>

#include <functional>
#include <span>
#include <string>

namespace lefort::mesh {

/// The rule applies to a boundary node if `distance_mm` at the node is at most `tolerance_mm`. If
/// `distance_mm` is signed (negative inside), the rule applies to all points inside.
struct BoundaryRule {
  std::string name;
  std::function<double(const Vec3&)> distance_mm;  ///< Of a point in L; called by many threads.
  double tolerance_mm = 0.0;
};

/// Adds a node set and a face set for each rule, for `rest`, and for the whole boundary
/// ("boundary").
///
/// A node belongs to the first rule that applies to it; without one, to `rest`. A face belongs to
/// the rule of most of its nodes; in a tie, to the first of these rules. The sets are disjoint:
/// each node and each face is in one of them, and in "boundary".
///
/// \param mesh    elements of any shape.
/// \param rules   distinct names, none of them "boundary" or `rest`; a rule that applies to no node
///   gets empty sets.
/// \param rest    name of the sets of all other nodes and faces.
/// \returns `mesh` with the sets added; sets of the same names are replaced.
[[nodiscard]] VolumeMesh name_boundary(VolumeMesh mesh, std::span<const BoundaryRule> rules,
                                       const std::string& rest = "free");

}  // namespace lefort::mesh
