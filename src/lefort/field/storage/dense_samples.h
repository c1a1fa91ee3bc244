/// \file
/// A number for every point of the lattice: Fuhrmann's partial distance field, one of the paper's
/// two baselines.
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

class DenseSamples {
 public:
  DenseSamples() = default;
  /// \param values  (resolution + 1)^3 distances [mm], x fastest; +-infinity or NaN beyond band.
  DenseSamples(int resolution, std::vector<float> values);

  [[nodiscard]] CellSamples cell(const LatticePoint& low) const;

  [[nodiscard]] int resolution() const { return resolution_; }
  [[nodiscard]] const std::vector<float>& values() const { return values_; }
  [[nodiscard]] std::size_t bytes() const { return values_.size() * sizeof(float); }

 private:
  int resolution_ = 0;
  std::vector<float> values_;
};

/// Samples brick by brick into one array \cite fuhrmann2003.
///
/// \param sampler  of `frame`, with a reach of frame.band_mm.
/// \param winding  of the surface, or null if it is open.
/// \returns kCancelled.
[[nodiscard]] Result<DenseSamples> build_dense(const BandSampler& sampler, const FieldFrame& frame,
                                               const WindingScanlines* winding, Progress& progress);

}  // namespace lefort::field
