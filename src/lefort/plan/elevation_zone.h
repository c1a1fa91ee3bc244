/// \file
/// Where the surgeon elevates periosteum and soft tissue: around the cut faces of the osteotomy.
#pragma once

#include <lefort/geometry/triangle_mesh.h>
#include <lefort/plan/cut_segments.h>
#include <lefort/plan/plan.h>

#include <optional>
#include <span>
#include <vector>

namespace lefort::plan {

/// Distances from the cut faces within which the surgeon elevates tissue [mm].
struct ElevationMargins {
  double segment_mm = 8.0;     ///< On the segment, >= 0.
  double other_side_mm = 8.0;  ///< On bone on the other side of the cut, >= 0.
};

/// Margins of a procedure. docs/theory/interface.md has the table and the reasons; no measurements
/// are known. In Le Fort osteotomies and genioplasty the segment keeps a pedicle of soft tissue for
/// its blood supply, so that less is elevated from it.
///
/// \param procedure  none: margins of an osteotomy without a template.
[[nodiscard]] ElevationMargins elevation_margins(std::optional<OsteotomyTemplate> procedure);

/// Cut faces of one osteotomy and the margins around them.
struct ElevationZone {
  geometry::TriangleMesh cut_faces_L;  ///< On the segment's side of the cut; may be empty.
  ElevationMargins margins;
};

/// \param surface_L  a bone after the cut.
/// \param osteotomy  its planes and curves.
/// \returns the triangles of `surface_L` that lie on a plane or curve of the osteotomy.
[[nodiscard]] geometry::TriangleMesh cut_faces(const geometry::TriangleMesh& surface_L,
                                               const Osteotomy& osteotomy);

/// Cut faces and margins of each osteotomy, in the order of the plan.
///
/// \param cut        result of cut_segments().
/// \param planned    the plan that was cut.
/// \param margin_mm  replaces the margins of all procedures, on both sides of the cut.
[[nodiscard]] std::vector<ElevationZone> elevation_zones(const CutSegments& cut,
                                                         std::span<const PlannedSegment> planned,
                                                         std::optional<double> margin_mm);

}  // namespace lefort::plan
