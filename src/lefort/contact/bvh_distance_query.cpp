#include <lefort/contact/distance_query.h>
#include <lefort/core/check.h>
#include <lefort/geometry/mesh_properties.h>

#include <cmath>
#include <utility>

namespace lefort::contact {
namespace {

class BvhDistanceQuery final : public DistanceQuery {
 public:
  BvhDistanceQuery(std::shared_ptr<const geometry::Bvh> surface_B, double max_distance_mm)
      : surface_B_(std::move(surface_B)),
        max_distance_mm_(max_distance_mm),
        is_closed_(!geometry::first_unbalanced_edge(surface_B_->mesh())) {}

  [[nodiscard]] double max_distance_mm() const override { return max_distance_mm_; }
  /// Nothing is missed. This is the resolution of a field with the same band and default options.
  [[nodiscard]] double resolution_mm() const override { return max_distance_mm_ / 5.0; }
  [[nodiscard]] bool is_closed() const override { return is_closed_; }
  [[nodiscard]] const geometry::TriangleMesh* surface_B() const override {
    return &surface_B_->mesh();
  }
  [[nodiscard]] bool has_exact_derivatives() const override { return false; }

  void measure(std::span<const Vec3> p_B, Derivatives /*no second ones*/,
               std::span<SignedDistanceSample> answers) const override {
    for (std::size_t i = 0; i < p_B.size(); ++i) answers[i] = measure(p_B[i]);
  }

 private:
  [[nodiscard]] SignedDistanceSample measure(const Vec3& p_B) const {
    using field::Zone;
    if (!p_B.allFinite()) return {.zone = Zone::kUnknown, .distance_mm = max_distance_mm_};
    const geometry::SignedDistance found = surface_B_->signed_distance(p_B);
    if (std::abs(found.distance_mm) > max_distance_mm_) {
      // Far from an open surface the sign of the pseudonormal is meaningless.
      if (!is_closed_) return {.zone = Zone::kUnknown, .distance_mm = max_distance_mm_};
      return found.distance_mm < 0.0
                 ? SignedDistanceSample{.zone = Zone::kInside, .distance_mm = -max_distance_mm_}
                 : SignedDistanceSample{.zone = Zone::kOutside, .distance_mm = max_distance_mm_};
    }
    // In a corner where the normals cancel: the direction from the closest point.
    Vec3 out_B = found.pseudonormal;
    if (!(out_B.norm() > 0.0)) out_B = p_B - found.nearest.point;
    return {.zone = Zone::kBand,
            .distance_mm = found.distance_mm,
            .gradient_B = out_B.stableNormalized()};
  }

  std::shared_ptr<const geometry::Bvh> surface_B_;
  double max_distance_mm_;
  bool is_closed_;
};

}  // namespace

std::shared_ptr<const DistanceQuery> bvh_distance_query(
    std::shared_ptr<const geometry::Bvh> surface_B, double max_distance_mm) {
  LEFORT_CHECK(surface_B != nullptr && max_distance_mm > 0.0);
  return std::make_shared<BvhDistanceQuery>(std::move(surface_B), max_distance_mm);
}

}  // namespace lefort::contact
