/// \file
/// How far is the bone: signed distance in a band around a surface, in the surface's own frame B.
///
/// Negative inside, positive outside (docs/conventions.md). A bone that moves moves the query,
/// never the field.
#pragma once

#include <lefort/core/types.h>
#include <lefort/field/octree.h>
#include <lefort/field/sparse_lattice.h>
#include <lefort/field/zone.h>

#include <cstddef>
#include <optional>

namespace lefort::field {

/// Distance as interpolated in one octree cell. Beyond the band the distance is +band_mm (kOutside,
/// kUnknown) or -band_mm (kInside) and the gradient zero.
struct FieldSample {
  Zone zone;
  double distance_mm;
  Vec3 gradient_B;  ///< Derivative of distance_mm; about, not exactly, of unit length.
};

/// Distance with continuous first and second derivatives. Beyond the band as in FieldSample.
struct SmoothSample {
  Zone zone;
  double distance_mm;
  Vec3 gradient_B;
  Mat3 hessian_B;  ///< [1/mm], symmetric.
};

/// What a field was made with, and where it lies.
struct FieldFrame {
  Vec3 origin_B = Vec3::Zero();  ///< Lowest corner of the cube.
  double cell_mm = 0.0;          ///< Edge of a finest cell.
  int resolution = 0;            ///< Finest cells along a side, a power of two.
  double band_mm = 0.0;          ///< Distances up to this are told.
  double tolerance_mm = 0.0;     ///< Every sample in the band is reproduced to this.
  bool closed = false;           ///< The surface encloses a volume: far sides are known.
};

struct FieldStatistics {
  Index leaves;              ///< Of the octree.
  Index band_leaves;         ///< Those that interpolate.
  Index stored_samples;      ///< Corner samples, each stored once.
  std::size_t octree_bytes;  ///< What sample() reads.
  std::size_t smooth_bytes;  ///< What sample_smooth() reads besides.
};

/// A finished field: immutable, cheap to move, safe to query from many threads.
///
/// Both answers say kBand exactly where their own value is at most band_mm; they differ by the
/// interpolation error, so within that of the edge of the band they may disagree. Every point
/// nearer to the surface than the band lies in a cell that interpolates; cells are kUnknown only
/// where the surface is open or its orientation contradicts itself, so that the sign tears.
class DistanceField {
 public:
  /// Takes the parts apart or together, for building and for files.
  /// \param smooth  coefficients of the cubic B-spline (spline_coefficients.h).
  DistanceField(const FieldFrame& frame, Octree octree, SparseLattice smooth);

  /// Trilinear between the corners of the octree cell at `p_B` (paper, section 2.2): continuous but
  /// for jumps of the order of the tolerance where cells of different size meet.
  ///
  /// A point outside box_B() is kOutside if the surface is closed, else kUnknown; a point that is
  /// not finite is kUnknown.
  [[nodiscard]] FieldSample sample(const Vec3& p_B) const;

  /// Twice continuously differentiable: a cubic B-spline over the finest lattice, whatever the size
  /// of the octree cells. Reproduces cubic polynomials; the error is of order cell_mm^4.
  [[nodiscard]] SmoothSample sample_smooth(const Vec3& p_B) const;

  [[nodiscard]] double band_mm() const { return frame_.band_mm; }
  [[nodiscard]] double cell_mm() const { return frame_.cell_mm; }
  [[nodiscard]] Box3 box_B() const;
  [[nodiscard]] const FieldFrame& frame() const { return frame_; }
  [[nodiscard]] FieldStatistics statistics() const;

  [[nodiscard]] const Octree& octree() const { return octree_; }
  [[nodiscard]] const SparseLattice& smooth_lattice() const { return smooth_; }

 private:
  struct Located {
    Vec3 u;  ///< Lattice coordinates.
    Octree::Place place;
  };
  [[nodiscard]] std::optional<Located> locate(const Vec3& p_B) const;
  [[nodiscard]] Zone zone_beyond_box(const Vec3& p_B) const;

  FieldFrame frame_;
  Octree octree_;
  SparseLattice smooth_;
};

}  // namespace lefort::field
