/// \file
/// Plan + skull surface -> the piece an osteotomy frees, and what stays.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/plan/plan.h>

namespace lefort::plan {

/// What an osteotomy cuts off but does not count as the segment: spicules, stray islands, and bones
/// that merely reach into it, such as the coronoid process of the mandible into a mid-face. Pieces
/// smaller than either bound stay with the remainder; a piece that the osteotomy holds must reach
/// the volume alone.
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
  Index segment_pieces = 0;          ///< Bodies the segment consists of.
  Index fragments = 0;               ///< Pieces that went back to the remainder.
  double fragment_volume_mm3 = 0.0;  ///< What they hold together; part of remainder_volume_mm3.
  double kerf_volume_mm3 = 0.0;      ///< What the saw took; in neither part.
};

/// Frees the segment of `osteotomy` from the skull.
///
/// \param skull_L   closed; several bodies and cavities are fine.
/// \returns both parts, or
///   - kPlanInvalid      the osteotomy has no plane or curve, or one that is not finite, has no
///     direction, or crosses itself; bounded planes stand beside other cuts; the kerf is negative
///     or
///     above 5 mm;
///   - kInvalidArgument  an option lies outside its range;
///   - kMeshInvalid      the skull is empty or open;
///   - kCutMissesBone    no bone (or crumbs alone) lies inside the cut, or none outside; a bounded
///     plane does not separate the bone; a point it should hold is further than 5 mm from any piece
///     of `min_piece_ml` within the cut; the saw leaves nothing of the rest;
///   - kMeshingFailed    the surface crosses itself along the cut, or volumes do not add up;
///   - kCancelled        `progress` asked to stop.
/// \note Volumes add up: segment + remainder + kerf are the skull within 0.1 % of it and within 1 %
///   of the smallest of them.
[[nodiscard]] Result<OsteotomyResult> perform_osteotomy(const geometry::TriangleMesh& skull_L,
                                                        const Osteotomy& osteotomy,
                                                        const OsteotomyOptions& options = {},
                                                        Progress& progress = Progress::none());

}  // namespace lefort::plan
