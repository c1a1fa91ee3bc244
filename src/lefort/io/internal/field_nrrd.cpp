#include <lefort/io/internal/field_formats.h>
#include <lefort/io/internal/raw_volume.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace lefort::io {

namespace {

using field::LatticePoint;
using field::LatticeWindow;
using field::SampleBlock;
using field::SampleCount;
using field::SparseLattice;

float exported(float sample, float band_mm) {
  if (std::isnan(sample)) return sample;
  if (std::isinf(sample)) return std::copysign(band_mm, sample);
  return within_band(sample, band_mm);
}

image::Grid grid_of(const field::FieldFrame& frame, const LatticeWindow& window) {
  image::Grid grid;
  for (std::size_t k = 0; k < 3; ++k) {
    grid.size[k] = window.count[k];
    grid.origin_L[int(k)] = frame.origin_B[int(k)] + frame.cell_mm * window.first[k];
  }
  grid.spacing_mm = Vec3::Constant(frame.cell_mm * window.every);
  return grid;
}

}  // namespace

Result<SampleCount> write_nrrd(const std::filesystem::path& target,
                               const field::DistanceField& field, const LatticeWindow& window,
                               Progress& progress) {
  constexpr int kSide = SparseLattice::kSide;
  const auto band_mm = float(field.band_mm());
  const image::Grid grid = grid_of(field.frame(), window);
  std::vector<float> values(std::size_t(window.size()));
  SampleCount count;
  LEFORT_TRY_VOID(for_each_block(field, window, progress, [&](const SampleBlock& block) {
    for (int place = 0; place < SparseLattice::kBrickPoints; ++place) {
      const LatticePoint p = {block.first[0] + place % kSide,
                              block.first[1] + place / kSide % kSide,
                              block.first[2] + place / (kSide * kSide)};
      const auto at = window.find(p);
      if (!at) continue;
      const float sample = block.zone ? zone_value(*block.zone) : block.values[std::size_t(place)];
      count.add(sample);
      values[std::size_t(grid.offset((*at)[0], (*at)[1], (*at)[2]))] = exported(sample, band_mm);
    }
  }));
  std::map<std::string, std::string> keys = describe_export(field, window);
  keys["lefort_unknown"] = "NaN";
  LEFORT_TRY_VOID(
      write_raw_volume(target, {grid, ScalarType::kFloat, values.data(), std::move(keys)}));
  return count;
}

}  // namespace lefort::io
