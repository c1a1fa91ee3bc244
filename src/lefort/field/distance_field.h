/// \file
/// Signed distance field of a surface, in a band around it, in the frame B of the surface.
///
/// Negative inside, positive outside (docs/conventions.md). If a bone moves, query points are
/// transformed to its frame; the field does not change.
#pragma once

#include <lefort/core/types.h>
#include <lefort/field/field_frame.h>
#include <lefort/field/field_sample.h>
#include <lefort/field/mesh_repair_report.h>
#include <lefort/field/storage/brick_samples.h>
#include <lefort/field/storage/dense_samples.h>
#include <lefort/field/storage/octree.h>
#include <lefort/field/storage/sparse_lattice.h>

#include <cstddef>
#include <optional>
#include <span>
#include <variant>

namespace lefort::field {

/// A distance field: immutable, cheap to move, safe for queries from several threads.
///
/// The zone of sample() is kBand where all samples around the point are known and not in conflict:
/// at least up to guaranteed_mm() from the surface, and at most up to band_mm() plus a cell. The
/// zone of sample_smooth() is kBand where the magnitude of its distance is at most band_mm(). Cells
/// whose samples are in conflict are kUnknown, as at the boundary of an open surface or where
/// triangles are inconsistently oriented. Beyond the band of an open surface all points are
/// kUnknown.
class DistanceField {
 public:
  using Samples = std::variant<BrickSamples, Octree, DenseSamples>;

  /// Assembles a field, for building it and for files.
  ///
  /// \param frame    lattice of the samples.
  /// \param samples  in one of three formats.
  /// \param smooth   values for sample_smooth() (spline_lattice.h), if needed.
  /// \param source   returned by source(); not used by queries.
  DistanceField(const FieldFrame& frame, Samples samples,
                std::optional<SparseLattice> smooth = std::nullopt,
                const std::optional<FieldSource>& source = std::nullopt);

  /// Trilinear interpolation of the samples around `p_B` (paper, section 2.2): continuous, except
  /// for jumps of the order of the tolerance where octree cells of different size meet.
  ///
  /// A point outside box_B() is kOutside if the surface is closed, otherwise kUnknown. A point that
  /// is not finite is kUnknown.
  ///
  /// \param p_B  query point [mm].
  [[nodiscard]] FieldSample sample(const Vec3& p_B) const;

  /// The same for several points; several times as fast per point. \pre as many results as points.
  void sample(std::span<const Vec3> p_B, std::span<FieldSample> results) const;

  /// Distances only [mm]: beyond the band +infinity outside the surface and -infinity inside it;
  /// NaN if unknown.
  /// \pre as many results as points.
  void distances(std::span<const Vec3> p_B, std::span<float> distances_mm) const;

  /// Estimate of the closest surface point [mm]: `p_B` minus the distance along the unit vector of
  /// the gradient. Exact if that point is on a flat face away from its edges. Nothing if the zone
  /// of sample() is not kBand, or the gradient is zero.
  [[nodiscard]] std::optional<Vec3> nearest_point(const Vec3& p_B) const;

  /// Continuously differentiable distance: piecewise cubic interpolation of the finest lattice,
  /// independent of the format of the samples (evaluate_spline.h). Where the distance is smooth the
  /// error is of order cell_mm^3. \pre is_smooth().
  [[nodiscard]] SmoothSample sample_smooth(const Vec3& p_B) const;
  /// The same for several points, faster. \pre as many results as points.
  void sample_smooth(std::span<const Vec3> p_B, std::span<SmoothSample> results) const;
  [[nodiscard]] bool is_smooth() const { return smooth_.has_value(); }

  [[nodiscard]] double band_mm() const { return frame_.band_mm; }
  [[nodiscard]] double guaranteed_mm() const { return frame_.guaranteed_mm(); }
  [[nodiscard]] double cell_mm() const { return frame_.cell_mm; }
  [[nodiscard]] Box3 box_B() const;
  [[nodiscard]] const FieldFrame& frame() const { return frame_; }
  [[nodiscard]] const Samples& samples() const { return samples_; }
  [[nodiscard]] const std::optional<SparseLattice>& smooth_lattice() const { return smooth_; }
  /// The surface the field was built from, if known.
  [[nodiscard]] const std::optional<FieldSource>& source() const { return source_; }

  /// Memory [bytes] used by sample(), and in addition by sample_smooth().
  [[nodiscard]] std::size_t sample_bytes() const;
  [[nodiscard]] std::size_t smooth_bytes() const { return smooth_ ? smooth_->bytes() : 0; }

  /// The samples at the corners of the cell with lowest corner `low`, 0 <= low < resolution; of an
  /// octree, those at the corners of the leaf that contains this cell.
  [[nodiscard]] CellSamples cell(const LatticePoint& low) const;

 private:
  FieldFrame frame_;
  Samples samples_;
  std::optional<SparseLattice> smooth_;
  std::optional<FieldSource> source_;
};

}  // namespace lefort::field
