/// \file
/// How far is the bone: signed distance in a band around a surface, in the surface's own frame B.
///
/// Negative inside, positive outside (docs/conventions.md). A bone that moves moves the query,
/// never the field.
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

/// A finished field: immutable, cheap to move, safe to query from many threads.
///
/// A query says kBand exactly where all samples around the point are known: at least up to
/// guaranteed_mm() from the surface, and nowhere beyond band_mm() and a cell. Cells are kUnknown
/// where the surface is open or its orientation contradicts itself, so that the sign tears.
class DistanceField {
 public:
  using Samples = std::variant<BrickSamples, Octree, DenseSamples>;

  /// Takes the parts apart or together, for building and for files.
  /// \param smooth  what sample_smooth() reads (spline_lattice.h), if it is wanted.
  /// \param source  told by source(); queries do not need it.
  DistanceField(const FieldFrame& frame, Samples samples,
                std::optional<SparseLattice> smooth = std::nullopt,
                const std::optional<FieldSource>& source = std::nullopt);

  /// Trilinear between the samples around `p_B` (paper, section 2.2): continuous, but for jumps of
  /// the order of the tolerance where octree cells of different size meet.
  ///
  /// A point outside box_B() is kOutside if the surface is closed, else kUnknown; a point that is
  /// not finite is kUnknown.
  [[nodiscard]] FieldSample sample(const Vec3& p_B) const;

  /// The same for many points, several times as fast. \pre as many results as points.
  void sample(std::span<const Vec3> p_B, std::span<FieldSample> results) const;

  /// Distances alone [mm]: +infinity beyond the band outside, -infinity inside, NaN where unknown.
  void distances(std::span<const Vec3> p_B, std::span<float> distances_mm) const;

  /// An estimate of the nearest point of the surface: along the gradient by the distance. Exact
  /// before flat faces; nothing where sample() is not kBand.
  [[nodiscard]] std::optional<Vec3> nearest_point(const Vec3& p_B) const;

  /// Continuously differentiable: piecewise cubic through the values of the finest lattice, however
  /// the samples are kept (evaluate_spline.h). Away from kinks the error is of order cell_mm^3.
  /// \pre is_smooth().
  [[nodiscard]] SmoothSample sample_smooth(const Vec3& p_B) const;
  /// The same for many points, faster. \pre as many results as points.
  void sample_smooth(std::span<const Vec3> p_B, std::span<SmoothSample> results) const;
  [[nodiscard]] bool is_smooth() const { return smooth_.has_value(); }

  [[nodiscard]] double band_mm() const { return frame_.band_mm; }
  [[nodiscard]] double guaranteed_mm() const { return frame_.guaranteed_mm(); }
  [[nodiscard]] double cell_mm() const { return frame_.cell_mm; }
  [[nodiscard]] Box3 box_B() const;
  [[nodiscard]] const FieldFrame& frame() const { return frame_; }
  [[nodiscard]] const Samples& samples() const { return samples_; }
  [[nodiscard]] const std::optional<SparseLattice>& smooth_lattice() const { return smooth_; }
  /// What it was made of, if that is known.
  [[nodiscard]] const std::optional<FieldSource>& source() const { return source_; }

  /// Memory that sample() reads, and that sample_smooth() reads besides.
  [[nodiscard]] std::size_t sample_bytes() const;
  [[nodiscard]] std::size_t smooth_bytes() const { return smooth_ ? smooth_->bytes() : 0; }

  /// The samples around the cell with lowest corner `low`, 0 <= low < resolution.
  [[nodiscard]] CellSamples cell(const LatticePoint& low) const;

 private:
  FieldFrame frame_;
  Samples samples_;
  std::optional<SparseLattice> smooth_;
  std::optional<FieldSource> source_;
};

}  // namespace lefort::field
