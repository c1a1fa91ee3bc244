/// \file
/// Landmarks of the skin estimated from the shape of head and bone, to define the regions of a face
/// without measured landmarks.
#pragma once

#include <lefort/core/error.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/plan/landmarks.h>

namespace lefort::compare {

/// Estimates the landmarks that FaceRegions::from() uses, for a head in a natural position (face
/// along -y, upright along z).
///
/// Two points are found: Prn, the most anterior point of the skin, and the lowest point of the bone
/// within 60 mm posterior to and 35 mm lateral of Prn (menton, on bone). The other heights follow
/// from h, the height of Prn above menton, and from L = 0.95 h, the height of Sn above soft menton,
/// by fractions close to the means of adult faces \cite farkas1994, heuristic: Sn at 0.15 h below
/// Prn; above Sn: Al at 0.05 L, En and Ex at 0.65 L, N' at 0.75 L; below Sn: Stm and Ch at L/3, Li
/// at 0.45 L, Pg' at 0.75 L, Me' at L. Half widths: Al 0.25 L, En 0.24 L, Ex 0.66 L, Ch 0.37 L. The
/// depth of each point is that of the most anterior skin within 6 mm of it, seen from the front;
/// without skin there, 20 mm posterior to Prn. Regions by these landmarks are approximate:
/// landmarks of the patient are better.
///
/// \param skin_L  of the head.
/// \param bone_L  skull and mandible.
/// \returns the landmarks; or kAnatomyMissing if the bone does not extend at least 30 mm below Prn.
[[nodiscard]] Result<plan::Landmarks> estimate_landmarks(const geometry::TriangleMesh& skin_L,
                                                         const geometry::TriangleMesh& bone_L);

}  // namespace lefort::compare
