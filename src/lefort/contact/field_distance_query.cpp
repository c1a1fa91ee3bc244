#include <lefort/contact/distance_query.h>
#include <lefort/core/check.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace lefort::contact {
namespace {

using field::DistanceField;
using field::FieldSample;
using field::SmoothSample;

/// Points per query of the field; limits the memory on the stack.
constexpr std::size_t kBlock = 64;

/// Second derivatives of the trilinear interpolant [1/mm]. Along one axis its gradient is linear
/// within a cell, so that a difference across the finest cell around a point is exact. The pure
/// derivatives are zero; differences along two axes give all three mixed ones.
class TrilinearHessians {
 public:
  /// \param points_B  at most kBlock points [mm].
  TrilinearHessians(const DistanceField& field, std::span<const Vec3> points_B) {
    constexpr double kInset = 0.01;  // Of a cell: keeps the ends inside the cell.
    const field::FieldFrame& frame = field.frame();
    std::array<Vec3, 4 * kBlock> ends_B;
    for (std::size_t i = 0; i < points_B.size(); ++i)
      for (int axis = 0; axis < 2; ++axis) {
        const double cell = std::floor((points_B[i][axis] - frame.origin_B[axis]) / frame.cell_mm);
        for (int end = 0; end < 2; ++end) {
          Vec3& p_B = ends_B[at(i, axis, end)];
          p_B = points_B[i];
          p_B[axis] =
              frame.origin_B[axis] + (cell + (end == 0 ? kInset : 1.0 - kInset)) * frame.cell_mm;
        }
      }
    field.sample(std::span(ends_B).first(4 * points_B.size()),
                 std::span(samples_).first(4 * points_B.size()));
    across_mm_ = (1.0 - 2.0 * kInset) * frame.cell_mm;
  }

  /// \returns the Hessian at a point; zero where an end of a difference lies beyond the band.
  [[nodiscard]] Mat3 of(std::size_t point) const {
    Mat3 hessian_B = Mat3::Zero();
    for (int axis = 0; axis < 2; ++axis) {
      const FieldSample &low = samples_[at(point, axis, 0)], &high = samples_[at(point, axis, 1)];
      if (low.zone != field::Zone::kBand || high.zone != field::Zone::kBand) return Mat3::Zero();
      const Vec3 change = (high.gradient_B - low.gradient_B) / across_mm_;
      for (int other = axis + 1; other < 3; ++other)
        hessian_B(axis, other) = hessian_B(other, axis) = change[other];
    }
    return hessian_B;
  }

 private:
  static std::size_t at(std::size_t point, int axis, int end) {
    return 4 * point + std::size_t(2 * axis + end);
  }

  std::array<FieldSample, 4 * kBlock> samples_;
  double across_mm_ = 0.0;
};

class FieldDistanceQuery : public DistanceQuery {
 public:
  FieldDistanceQuery(std::shared_ptr<const DistanceField> field_B,
                     std::shared_ptr<const geometry::TriangleMesh> surface_B)
      : field_B_(std::move(field_B)), surface_B_(std::move(surface_B)) {}
  [[nodiscard]] double resolution_mm() const override { return field_B_->cell_mm(); }
  [[nodiscard]] bool is_closed() const override { return field_B_->frame().closed; }
  [[nodiscard]] bool has_exact_derivatives() const override { return true; }
  [[nodiscard]] const geometry::TriangleMesh* surface_B() const override {
    return surface_B_.get();
  }

 protected:
  [[nodiscard]] const DistanceField& field_B() const { return *field_B_; }

 private:
  std::shared_ptr<const DistanceField> field_B_;
  std::shared_ptr<const geometry::TriangleMesh> surface_B_;
};

class TrilinearDistanceQuery final : public FieldDistanceQuery {
 public:
  using FieldDistanceQuery::FieldDistanceQuery;
  /// All samples around a point are needed.
  [[nodiscard]] double max_distance_mm() const override { return field_B().guaranteed_mm(); }

  void measure(std::span<const Vec3> p_B, Derivatives derivatives,
               std::span<SignedDistanceSample> answers) const override {
    std::array<FieldSample, kBlock> samples;
    for (std::size_t begin = 0; begin < p_B.size(); begin += kBlock) {
      const auto points = p_B.subspan(begin, std::min(kBlock, p_B.size() - begin));
      field_B().sample(points, std::span(samples).first(points.size()));
      for (std::size_t i = 0; i < points.size(); ++i) {
        SignedDistanceSample& answer = answers[begin + i];
        answer.zone = samples[i].zone;
        answer.distance_mm = samples[i].distance_mm;
        answer.gradient_B = samples[i].gradient_B;
        answer.hessian_B.setZero();
      }
      if (derivatives == Derivatives::kFirst) continue;
      const TrilinearHessians hessians(field_B(), points);
      for (std::size_t i = 0; i < points.size(); ++i)
        if (samples[i].zone == field::Zone::kBand) answers[begin + i].hessian_B = hessians.of(i);
    }
  }
};

class SmoothDistanceQuery final : public FieldDistanceQuery {
 public:
  using FieldDistanceQuery::FieldDistanceQuery;
  /// The spline is defined wherever the field is sampled.
  [[nodiscard]] double max_distance_mm() const override { return field_B().band_mm(); }

  void measure(std::span<const Vec3> p_B, Derivatives derivatives,
               std::span<SignedDistanceSample> answers) const override {
    std::array<SmoothSample, kBlock> samples;
    for (std::size_t begin = 0; begin < p_B.size(); begin += kBlock) {
      const auto points = p_B.subspan(begin, std::min(kBlock, p_B.size() - begin));
      field_B().sample_smooth(points, std::span(samples).first(points.size()));
      for (std::size_t i = 0; i < points.size(); ++i)
        answers[begin + i] = {
            samples[i].zone, samples[i].distance_mm, samples[i].gradient_B,
            derivatives == Derivatives::kSecond ? samples[i].hessian_B : Mat3::Zero()};
    }
  }
};

}  // namespace

Result<std::shared_ptr<const DistanceQuery>> field_distance_query(
    std::shared_ptr<const DistanceField> field_B, DetectionMethod detection,
    std::shared_ptr<const geometry::TriangleMesh> surface_B) {
  LEFORT_CHECK(field_B != nullptr && detection != DetectionMethod::kBvh);
  if (detection == DetectionMethod::kTrilinear)
    return std::make_shared<TrilinearDistanceQuery>(std::move(field_B), std::move(surface_B));
  if (!field_B->is_smooth())
    return fail(
        ErrorCode::kInvalidArgument,
        "the field was built without --smooth; rebuild it with --smooth, or choose detection "
        "trilinear");
  return std::make_shared<SmoothDistanceQuery>(std::move(field_B), std::move(surface_B));
}

}  // namespace lefort::contact
