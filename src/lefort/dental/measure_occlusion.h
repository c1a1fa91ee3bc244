/// \file
/// Contacts, overjet and overbite of two arches.
#pragma once

#include <lefort/core/types.h>
#include <lefort/geometry/bvh.h>

#include <optional>
#include <vector>

namespace lefort::dental {

/// Directions of the arches in frame L: unit vectors, perpendicular to each other.
struct ArchAxes {
  Vec3 superior_L = Vec3::UnitZ();   ///< Perpendicular to the occlusal plane.
  Vec3 anterior_L = -Vec3::UnitY();  ///< In the mid-sagittal plane.
  [[nodiscard]] Vec3 left_L() const { return superior_L.cross(anterior_L); }
};

/// Contact of the arches in occlusion.
struct OcclusalContacts {
  double left_mm2 = 0.0, right_mm2 = 0.0;  ///< Area of lower teeth within kContactGap_mm.
  Index patches = 0;                       ///< Connected patches of these areas.
  double max_penetration_mm = 0.0;
};
inline constexpr double kContactGap_mm = 0.2;
inline constexpr double kMaxOcclusalPenetration_mm = 0.1;

/// An occlusion.
struct Occlusion {
  RigidTransform X_L_lower = RigidTransform::Identity();  ///< Movement of the lower arch.
  OcclusalContacts contacts;
  /// Of incisal_edges(), upper relative to lower [mm]: to anterior and to inferior (overbite), edge
  /// to edge; NaN if there are none.
  double overjet_mm = 0.0, overbite_mm = 0.0;
  /// Gap of each vertex of the lower arch [mm], negative if it penetrates; NaN further than 3 mm
  /// from the upper one.
  std::vector<double> gaps_mm;
};

/// Both arches; the lower one where it was scanned.
struct Arches {
  geometry::Bvh upper, lower;
};

/// Edges of opposite incisors.
struct IncisalEdges {
  Vec3 upper_L, lower_L;
};

/// The upper edge is the vertex furthest to inferior of the most anterior 8 mm, within 8 mm of the
/// middle of the arch; the lower one is that furthest to superior within 4 mm of the upper edge.
///
/// \param upper_L, lower_L  the arches, where they are.
/// \returns nothing if there is nothing opposite.
[[nodiscard]] std::optional<IncisalEdges> incisal_edges(const geometry::TriangleMesh& upper_L,
                                                        const geometry::TriangleMesh& lower_L,
                                                        const ArchAxes& axes);

/// Penetration is searched up to this depth. Arches are open: behind the side of a tooth at the end
/// of a piece (in the place of the lower arch), a point of the other arch looks as if it were
/// inside.
inline constexpr double kArchReach_mm = 10.0, kPieceReach_mm = 2.0;

/// \param X_LB      position of the lower arch.
/// \param reach_mm  deeper points of the upper arch do not count.
/// \returns the deepest penetration of a vertex of one arch into the other one [mm], 0 if none.
[[nodiscard]] double max_penetration_mm(const Arches& arches, const RigidTransform& X_LB,
                                        double reach_mm = kArchReach_mm);

/// \param X_LB      position of the lower arch.
/// \param reach_mm  as for max_penetration_mm().
/// \returns the contacts and distances there.
[[nodiscard]] Occlusion measure_occlusion(const Arches& arches, const RigidTransform& X_LB,
                                          const ArchAxes& axes, double reach_mm = kArchReach_mm);

}  // namespace lefort::dental
