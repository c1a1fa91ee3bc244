#include <lefort/core/check.h>
#include <lefort/field/distance_field.h>
#include <lefort/field/query/evaluate_spline.h>
#include <lefort/field/query/query_bricks.h>
#include <lefort/field/query/trilinear.h>
#include <lefort/field/storage/octree_cells.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace lefort::field {

namespace {

/// Smooth samples evaluated together; limited by the stack.
constexpr std::size_t kSmoothBlock = 64;

struct Located {
  Vec3 u;  ///< Lattice coordinates.
  LatticePoint cell;
};

std::optional<Located> locate(const FieldFrame& frame, const Vec3& p_B) {
  Located at{(p_B - frame.origin_B) * (1.0 / frame.cell_mm), {}};
  const bool in_box = (at.u.array() >= 0.0).all() && (at.u.array() <= frame.resolution).all();
  if (!in_box) return std::nullopt;  // Also if NaN.
  for (int k = 0; k < 3; ++k)
    at.cell[std::size_t(k)] = std::min(int(at.u[k]), frame.resolution - 1);
  return at;
}

/// For octrees and dense samples; bricks have their own implementation.
template <class Samples>
FieldSample sample_cells(const Samples& samples, const FieldFrame& frame, const Vec3& p_B) {
  const std::optional<Located> at = locate(frame, p_B);
  if (!at) return beyond_band(zone_beyond_box(frame, p_B), frame.band_mm);
  const CellSamples cell = samples.cell(at->cell);
  const Zone zone = cell.cells == 1 ? zone_of_fine_cell(cell.corners, float(frame.cell_mm))
                                    : zone_of(cell.corners);
  if (zone != Zone::kBand) return beyond_band(zone, frame.band_mm);
  std::array<double, 3> t{};
  std::array<double, 8> corners{};
  for (std::size_t k = 0; k < 3; ++k) t[k] = (at->u[int(k)] - cell.low[k]) / cell.cells;
  std::copy(cell.corners.begin(), cell.corners.end(), corners.begin());
  const std::array<double, 3> gradient = trilinear_gradient(corners, t);
  const double per_mm = 1.0 / (cell.cells * frame.cell_mm);
  return {Zone::kBand, trilinear(corners, t),
          Vec3(gradient[0] * per_mm, gradient[1] * per_mm, gradient[2] * per_mm)};
}

}  // namespace

DistanceField::DistanceField(const FieldFrame& frame, Samples samples,
                             std::optional<SparseLattice> smooth,
                             const std::optional<FieldSource>& source)
    : frame_(frame), samples_(std::move(samples)), smooth_(std::move(smooth)), source_(source) {
  LEFORT_CHECK(frame_.cell_mm > 0.0 && frame_.band_mm > 0.0);
  LEFORT_CHECK(std::visit([](const auto& s) { return s.resolution(); }, samples_) ==
               frame_.resolution);
  LEFORT_CHECK(!smooth_ || smooth_->resolution() == frame_.resolution);
}

Box3 DistanceField::box_B() const {
  const Vec3 sides = Vec3::Constant(frame_.cell_mm * frame_.resolution);
  return {frame_.origin_B, frame_.origin_B + sides};
}

void DistanceField::sample(std::span<const Vec3> p_B, std::span<FieldSample> results) const {
  LEFORT_CHECK(p_B.size() == results.size());
  if (const auto* bricks = std::get_if<BrickSamples>(&samples_))
    return sample_bricks(*bricks, frame_, p_B, results);
  for (std::size_t i = 0; i < p_B.size(); ++i)
    results[i] = std::visit(
        [&](const auto& samples) { return sample_cells(samples, frame_, p_B[i]); }, samples_);
}

FieldSample DistanceField::sample(const Vec3& p_B) const {
  FieldSample result{};
  sample(std::span(&p_B, 1), std::span(&result, 1));
  return result;
}

void DistanceField::distances(std::span<const Vec3> p_B, std::span<float> distances_mm) const {
  LEFORT_CHECK(p_B.size() == distances_mm.size());
  if (const auto* bricks = std::get_if<BrickSamples>(&samples_))
    return distances_in_bricks(*bricks, frame_, p_B, distances_mm);
  for (std::size_t i = 0; i < p_B.size(); ++i) {
    const FieldSample found = sample(p_B[i]);
    distances_mm[i] = found.zone == Zone::kBand ? float(found.distance_mm) : zone_value(found.zone);
  }
}

std::optional<Vec3> DistanceField::nearest_point(const Vec3& p_B) const {
  const FieldSample found = sample(p_B);
  const double slope = found.gradient_B.norm();
  if (found.zone != Zone::kBand || !(slope > 0.0)) return std::nullopt;
  return p_B - found.distance_mm / slope * found.gradient_B;
}

void DistanceField::sample_smooth(std::span<const Vec3> p_B,
                                  std::span<SmoothSample> results) const {
  LEFORT_CHECK(smooth_.has_value() && p_B.size() == results.size());
  const double per_mm = 1.0 / frame_.cell_mm;
  const auto beyond = [&](Zone zone) {
    return SmoothSample{zone, zone == Zone::kInside ? -frame_.band_mm : frame_.band_mm,
                        Vec3::Zero(), Mat3::Zero()};
  };
  std::array<std::optional<Located>, kSmoothBlock> at;
  std::array<Vec3, kSmoothBlock> u;
  std::array<SplineValue, kSmoothBlock> splines;
  for (std::size_t begin = 0; begin < p_B.size(); begin += kSmoothBlock) {
    const std::size_t count = std::min(kSmoothBlock, p_B.size() - begin);
    for (std::size_t i = 0; i < count; ++i) {
      at[i] = locate(frame_, p_B[begin + i]);
      u[i] = at[i] ? at[i]->u : Vec3::Zero();  // Not used.
    }
    evaluate_splines(*smooth_, std::span(u).first(count), std::span(splines).first(count));
    for (std::size_t i = 0; i < count; ++i) {
      SmoothSample& result = results[begin + i];
      const SplineValue& spline = splines[i];
      if (!at[i]) {
        result = beyond(zone_beyond_box(frame_, p_B[begin + i]));
      } else if (std::abs(spline.value) <= frame_.band_mm) {  // False for NaN.
        result.zone = Zone::kBand;
        result.distance_mm = spline.value;
        result.gradient_B = per_mm * spline.gradient;
        result.hessian_B = (per_mm * per_mm) * spline.hessian;
      } else if (frame_.closed && std::isfinite(spline.value)) {
        result = beyond(spline.value < 0.0 ? Zone::kInside : Zone::kOutside);
      } else {
        const Zone zone = zone_of(cell(at[i]->cell).corners);
        result = beyond(zone == Zone::kBand ? Zone::kUnknown : zone);
      }
    }
  }
}

SmoothSample DistanceField::sample_smooth(const Vec3& p_B) const {
  SmoothSample result{};
  sample_smooth(std::span(&p_B, 1), std::span(&result, 1));
  return result;
}

CellSamples DistanceField::cell(const LatticePoint& low) const {
  return std::visit([&](const auto& samples) { return samples.cell(low); }, samples_);
}

std::size_t DistanceField::sample_bytes() const {
  return std::visit([](const auto& samples) { return samples.bytes(); }, samples_);
}

}  // namespace lefort::field
