/// \file
/// Signed distance, gradient and Hessian of a rigid body at points given in its own frame B, by one
/// of three methods.
///
/// | method     | distance                              | derivatives                             |
/// |------------|---------------------------------------|-----------------------------------------|
/// | kSmooth    | cubic interpolation of the field, C1  | exact; the Hessian jumps at cell faces  |
/// | kTrilinear | trilinear interpolation of the field  | exact in a cell; the gradient jumps     |
/// | kBvh       | closest point of the triangles        | pseudonormal; no Hessian, no potential  |
///
/// measure_gap.h transforms points and results of a body that has moved.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/field/distance_field.h>
#include <lefort/field/zone.h>
#include <lefort/geometry/bvh.h>
#include <lefort/geometry/triangle_mesh.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

namespace lefort::contact {

/// Method of a distance query.
enum class DetectionMethod : std::uint8_t {
  kSmooth,     ///< Cubic interpolation of the field: continuously differentiable.
  kTrilinear,  ///< Trilinear interpolation, as in the paper.
  kBvh,        ///< Bounding volume hierarchy; the baseline of the paper.
};

/// Name in plans and results.
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

/// Highest derivatives that a query computes.
enum class Derivatives : std::uint8_t { kFirst, kSecond };

/// Result at one point.
///
/// | zone     | where                                       | distance_mm           | derivatives |
/// |----------|---------------------------------------------|-----------------------|-------------|
/// | kBand    | at least up to max_distance_mm()            | signed distance       | as queried  |
/// | kOutside | outside, further away                       | >= max_distance_mm()  | zero        |
/// | kInside  | inside, further away                        | <= -max_distance_mm() | zero        |
/// | kUnknown | sign not known, or point not finite         | not defined           | zero        |
///
/// The sign is not known near a hole of the surface; far from an open surface it may be unknown.
struct SignedDistanceSample {
  field::Zone zone = field::Zone::kOutside;
  double distance_mm = 0.0;        ///< Negative inside.
  Vec3 gradient_B = Vec3::Zero();  ///< Outward; of unit length except for sampling errors.
  Mat3 hessian_B = Mat3::Zero();   ///< Of distance_mm [1/mm]; zero if not computed.
};

/// Distance of points to one body. Immutable and thread-safe.
class DistanceQuery {
 public:
  DistanceQuery() = default;
  virtual ~DistanceQuery() = default;
  DistanceQuery(const DistanceQuery&) = delete;
  DistanceQuery& operator=(const DistanceQuery&) = delete;

  /// \returns the range: up to this distance from the surface, on both sides, every point has a
  ///   distance [mm].
  [[nodiscard]] virtual double max_distance_mm() const = 0;

  /// \returns the size below which parts of the body may be missed [mm].
  [[nodiscard]] virtual double resolution_mm() const = 0;

  /// \returns whether the surface encloses a volume.
  [[nodiscard]] virtual bool is_closed() const = 0;

  /// \returns whether gradient_B is the derivative of distance_mm, and hessian_B that of
  ///   gradient_B, wherever they exist. If not, a force along the gradient has no potential.
  [[nodiscard]] virtual bool has_exact_derivatives() const = 0;

  /// \returns the triangles of the body, or null if they are not known.
  [[nodiscard]] virtual const geometry::TriangleMesh* surface_B() const { return nullptr; }

  /// Measures many points, on the calling thread.
  ///
  /// \param p_B          points [mm]; a point that is not finite is kUnknown.
  /// \param derivatives  that are computed.
  /// \param answers      one per point.
  virtual void measure(std::span<const Vec3> p_B, Derivatives derivatives,
                       std::span<SignedDistanceSample> answers) const = 0;
};

/// Distance query by interpolation of a field. The second derivatives of kTrilinear are those
/// within a cell.
///
/// \param field_B    \pre not null.
/// \param detection  kSmooth or kTrilinear.
/// \param surface_B  the triangles from which the field was built; may be null.
/// \returns kInvalidArgument for kSmooth if the field was built without smooth interpolation.
[[nodiscard]] Result<std::shared_ptr<const DistanceQuery>> field_distance_query(
    std::shared_ptr<const field::DistanceField> field_B, DetectionMethod detection,
    std::shared_ptr<const geometry::TriangleMesh> surface_B = nullptr);

/// Distance query by the closest point on the triangles. Sign and normal are those of the
/// pseudonormal of the closest face, edge or vertex (\cite baerentzen2005). The pseudonormal equals
/// the gradient of the distance only where the closest point is inside a face. No second
/// derivatives. No part of the body is missed, although resolution_mm() is a fifth of the range.
///
/// \param surface_B        \pre not null.
/// \param max_distance_mm  range of the query, > 0.
[[nodiscard]] std::shared_ptr<const DistanceQuery> bvh_distance_query(
    std::shared_ptr<const geometry::Bvh> surface_B, double max_distance_mm);

}  // namespace lefort::contact
