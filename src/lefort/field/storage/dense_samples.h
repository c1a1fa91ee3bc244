/// \file
/// A sample for every lattice point: Fuhrmann's partial distance field, one of the paper's two
/// baselines.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/field/build/band_sampler.h>
#include <lefort/field/field_frame.h>
#include <lefort/field/query/cell_samples.h>
#include <lefort/field/sign/winding_scanlines.h>

#include <cstddef>
#include <vector>

namespace lefort::field {

/// Distance samples in one dense array.
class DenseSamples {
 public:
  DenseSamples() = default;
  /// \param resolution  cells along an edge of the cube.
  /// \param values      (resolution + 1)^3 distances [mm], x fastest; beyond the band +infinity
  ///   outside the surface, -infinity inside it, or NaN.
  DenseSamples(int resolution, std::vector<float> values);

  [[nodiscard]] CellSamples cell(const LatticePoint& low) const;

  [[nodiscard]] int resolution() const { return resolution_; }
  [[nodiscard]] const std::vector<float>& values() const { return values_; }
  [[nodiscard]] std::size_t bytes() const { return values_.size() * sizeof(float); }

 private:
  int resolution_ = 0;
  std::vector<float> values_;
};

/// Samples the bricks of the band into one array \cite fuhrmann2003.
///
/// \param sampler   of `frame`, with frame.band_mm.
/// \param frame     lattice of the field.
/// \param winding   of the surface, or null if it is open.
/// \param progress  receives the fraction done; may cancel.
/// \returns the samples, or kCancelled.
[[nodiscard]] Result<DenseSamples> build_dense(const BandSampler& sampler, const FieldFrame& frame,
                                               const WindingScanlines* winding, Progress& progress);

}  // namespace lefort::field
