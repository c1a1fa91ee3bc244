/// \file
/// How far points are from a bone at rest, and which way out leads: one question, three ways to
/// answer it. Detectors know the bone in its own frame B and never move; a plan moves the question
/// (measure_gap.h).
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/field/distance_field.h>
#include <lefort/field/zone.h>
#include <lefort/geometry/bvh.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

namespace lefort::contact {

/// Who answers.
enum class DetectionMethod : std::uint8_t {
  kSmooth,     ///< The field read cubically: continuously differentiable; its Hessian may jump.
  kTrilinear,  ///< The field as in the paper, section 2.2. Its gradient jumps at cell faces.
  kBvh,        ///< A tree of boxes over the triangles; the paper's conventional baseline.
};

/// As plans and results call it.
[[nodiscard]] constexpr std::string_view name_of(DetectionMethod detection) {
  switch (detection) {
    case DetectionMethod::kTrilinear:
      return "trilinear";
    case DetectionMethod::kBvh:
      return "bvh";
    default:
      return "smooth";
  }
}

/// How far the derivatives of a distance are wanted.
enum class Derivatives : std::uint8_t { kFirst, kSecond };

/// How far a point is from a bone.
///
/// Beyond a detector's reach `zone` says on which side, the distance is plus or minus the reach and
/// the derivatives are zero: a point deeper than the detector can tell is seen, but knows no way
/// out. Where the surface has a hole that does not say, it is kUnknown.
struct SignedDistanceSample {
  field::Zone zone = field::Zone::kOutside;
  double distance_mm = 0.0;        ///< Negative is penetration.
  Vec3 gradient_B = Vec3::Zero();  ///< Out of the bone; of length one but for sampling.
  Mat3 hessian_B = Mat3::Zero();   ///< Of distance_mm [1/mm]; zero unless asked for.
};

/// Immutable; safe to ask from many threads.
class DistanceQuery {
 public:
  DistanceQuery() = default;
  virtual ~DistanceQuery() = default;
  DistanceQuery(const DistanceQuery&) = delete;
  DistanceQuery& operator=(const DistanceQuery&) = delete;

  /// Up to this far from the surface, on both sides, every point has a distance [mm].
  [[nodiscard]] virtual double max_distance_mm() const = 0;

  /// What is thinner may be missed [mm].
  [[nodiscard]] virtual double resolution_mm() const = 0;

  /// Whether the surface encloses a volume, so that there is an inside.
  [[nodiscard]] virtual bool is_closed() const = 0;

  /// Whether gradient_B is the derivative of distance_mm, and hessian_B of gradient_B, wherever
  /// they exist. If not, a force along the gradient has no potential.
  [[nodiscard]] virtual bool has_exact_derivatives() const = 0;

  /// Answers for many points, on the calling thread.
  ///
  /// \param p_B      [mm]; one that is not finite is kUnknown.
  /// \param answers  as many as points.
  virtual void measure(std::span<const Vec3> p_B, Derivatives derivatives,
                       std::span<SignedDistanceSample> answers) const = 0;
};

/// Asks the field. The second derivatives of the trilinear reading are those within a cell.
///
/// \param detection  kSmooth or kTrilinear.
/// \returns kInvalidArgument if the smooth reading is wanted of a field that was built without.
[[nodiscard]] Result<std::shared_ptr<const DistanceQuery>> field_distance_query(
    std::shared_ptr<const field::DistanceField> field_B, DetectionMethod detection);

/// Asks the tree: the exact nearest point, its sign and normal by the pseudonormal of the feature
/// it lies on (\cite baerentzen2005). That normal is the distance's gradient before faces alone:
/// before an edge or a corner it does not turn as the point passes. No second derivatives.
///
/// \param max_distance_mm  > 0; the tree itself knows no end.
[[nodiscard]] std::shared_ptr<const DistanceQuery> bvh_distance_query(
    std::shared_ptr<const geometry::Bvh> surface_B, double max_distance_mm);

}  // namespace lefort::contact
