/// \file
/// Virtual osteotomy: divides the surface of the skull into segment and remainder.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/plan/fragments.h>
#include <lefort/plan/plan.h>

#include <vector>

namespace lefort::plan {

/// Which pieces within the cut are fragments: spicules, islands, and other bones that extend into
/// the cut (the coronoid process into a midface). Without anchor points, a piece smaller than
/// either bound is a fragment. With anchor points, a piece on which one of them lies belongs to the
/// segment if it has at least `min_piece_ml`; all other pieces are fragments. assign_fragments()
/// gives each fragment to a part of the bone.
struct OsteotomyOptions {
  double min_piece_ml = 0.5;         ///< >= 0.
  double min_piece_fraction = 0.05;  ///< Of the largest piece's volume, 0 to 1.
};

/// A skull in two closed parts, both counter-clockwise seen from outside.
struct OsteotomyResult {
  geometry::TriangleMesh segment_L;
  geometry::TriangleMesh remainder_L;
  double skull_volume_mm3 = 0.0;
  double segment_volume_mm3 = 0.0;
  double remainder_volume_mm3 = 0.0;
  Index segment_pieces = 0;  ///< Bodies the segment consists of.
  std::vector<Fragment> fragments;
  double left_out_volume_mm3 = 0.0;  ///< Of fragments without an owner; in neither part.
  double kerf_volume_mm3 = 0.0;      ///< Bone removed by the saw; in neither part.
};

/// Separates the segment of `osteotomy` from the skull.
///
/// \param skull_L    closed; several bodies and cavities are allowed.
/// \param osteotomy  planes or curves.
/// \param options    below these bounds, pieces are fragments.
/// \param progress   of the cuts; may request a stop.
/// \returns both parts, or
///   - kPlanInvalid      the osteotomy or an additional region has no plane or curve, or one that
///     is not finite, has no direction, a size or depth of 0 or less, or crosses itself; bounded
///     planes are combined with other cuts; the kerf is negative or above 5 mm; an anchor point is
///     not finite;
///   - kInvalidArgument  an option lies outside its range, or a curve widened by the kerf crosses
///     itself;
///   - kMeshInvalid      the skull is empty or open;
///   - kCutMissesBone    no bone (or only fragments) lies inside the cut, or none outside; a
///     bounded plane does not separate the bone; an anchor point is more than 5 mm from any piece
///     of `min_piece_ml` within the cut; the kerf removes all of the remainder;
///   - kMeshingFailed    the surface crosses itself along the cut, the cutting solids cannot be
///     combined, or volumes do not add up;
///   - kCancelled        `progress` requested a stop.
/// \note segment + remainder + kerf + left out equal the volume of the skull within 0.1 % of the
///   skull and within 1 % of the smallest of the first three that is not empty.
[[nodiscard]] Result<OsteotomyResult> perform_osteotomy(const geometry::TriangleMesh& skull_L,
                                                        const Osteotomy& osteotomy,
                                                        const OsteotomyOptions& options = {},
                                                        Progress& progress = Progress::none());

}  // namespace lefort::plan
