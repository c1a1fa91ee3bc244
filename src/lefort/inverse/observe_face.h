/// \file
/// Residuals of a face with respect to a target, with derivatives by the positions of the skin.
///
/// Each residual depends on at most three vertices of the skin:
///
/// - landmark: the point that has fixed barycentric coordinates b in a triangle, minus its wanted
///   position; or one component of that difference;
/// - profile: y of the first point of the skin on the ray (x, y, z) from anterior at the height z.
///   If the triangle with normal n is hit at coordinates b and its vertices move by d_i, the hit
///   moves along the ray e by n . sum b_i d_i / (n . e);
/// - surface: signed distance of a vertex to the closest point of the target; its derivative is
///   the unit vector from that point (\cite baerentzen2005). Only vertices count whose closest
///   point at rest is near and not on the border of the target. The residual is truncated at
///   `max_distance_mm`, where its derivative is zero, so that the objective does not fall when a
///   vertex leaves the target.
///
/// A point of a profile that the skin has left has the residual kMaxMotion_mm without derivative.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/geometry/bvh.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/inverse/target.h>

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lefort::inverse {

/// One residual.
struct Observation {
  double residual_mm = 0.0;  ///< Reached minus wanted.
  double weight = 0.0;       ///< Of its square in 2 J, >= 0: that of the target times the fraction.
  double fraction = 1.0;     ///< In the mean square of the target.
  std::size_t target = 0;    ///< Number of FaceTarget::name().
  int components = 1;        ///< 3: this and two neighbors are components of one vector.
  Vec3 at_L = Vec3::Zero();  ///< Where it is measured [mm].
  std::array<std::int32_t, 3> vertices{0, 0, 0};
  std::array<Vec3, 3> gradient{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};  ///< By these vertices.
};

/// Observes faces that are displacements of one skin.
class FaceObserver {
 public:
  /// \param skin_L    at rest.
  /// \param is_moved  one for each vertex: whether tissue of the mesh can move it.
  /// \param target    \pre weights, positions and directions are valid and finite.
  /// \returns the observer; or kInvalidArgument, naming the target, if
  ///   - there is no target with a positive weight;
  ///   - the skin is further than kMaxLandmarkDistance_mm from a landmark, or tissue does not move
  ///     it there;
  ///   - a wanted position lies more than kMaxMotion_mm from the present one;
  ///   - there is no skin at a point of a profile;
  ///   - less than kMinOverlap of the skin in the region is close to a surface, or there is none.
  [[nodiscard]] static Result<FaceObserver> create(geometry::TriangleMesh skin_L,
                                                   std::span<const char> is_moved,
                                                   FaceTarget target);

  /// \param displacement_mm  of each vertex.
  /// \returns the residuals of all targets, in their order; always the same number.
  [[nodiscard]] std::vector<Observation> observe(std::span<const Vec3> displacement_mm) const;

  /// \returns y of the profile of the face at each height, or nothing without skin there.
  [[nodiscard]] std::vector<std::optional<double>> profile_y_mm(
      std::span<const Vec3> displacement_mm, double x_mm, std::span<const double> z_mm) const;

  [[nodiscard]] const FaceTarget& target() const { return target_; }
  [[nodiscard]] const geometry::TriangleMesh& skin_L() const { return skin_L_; }

  static constexpr double kMaxLandmarkDistance_mm = 10.0;
  static constexpr double kMaxMotion_mm = 50.0;
  static constexpr double kMinOverlap = 0.5;  ///< Fraction of the area.

 private:
  /// A point of the skin with fixed coordinates.
  struct Anchor {
    std::array<std::int32_t, 3> vertices;
    Vec3 weights;
  };
  struct Hit {
    double y_mm;
    std::int32_t triangle;
    Vec3 weights;
  };

  FaceObserver(geometry::TriangleMesh skin_L, FaceTarget target)
      : skin_L_(std::move(skin_L)), target_(std::move(target)) {}

  [[nodiscard]] Vec3 position(std::int32_t v, std::span<const Vec3> displacement_mm) const {
    return skin_L_.vertices[std::size_t(v)] + displacement_mm[std::size_t(v)];
  }
  void observe_landmarks(std::span<const Vec3> displacement_mm,
                         std::vector<Observation>& all) const;
  void observe_profile(std::size_t profile, std::span<const Vec3> displacement_mm,
                       std::vector<Observation>& all) const;
  void observe_surface(std::size_t surface, std::span<const Vec3> displacement_mm,
                       std::vector<Observation>& all) const;
  [[nodiscard]] Result<void> anchor_landmarks(std::span<const char> is_moved);
  [[nodiscard]] Result<void> check_profiles(std::span<const char> is_moved);
  [[nodiscard]] Result<void> choose_vertices(std::span<const char> is_moved);
  [[nodiscard]] Result<void> choose_vertices(const SurfaceTarget& of,
                                             std::span<const char> is_moved,
                                             std::span<const double> areas_mm2);
  [[nodiscard]] std::vector<std::int32_t> triangles_near(double x_mm) const;
  [[nodiscard]] std::optional<Hit> hit_at(std::span<const Vec3> displacement_mm,
                                          std::span<const std::int32_t> triangles, double x_mm,
                                          double z_mm) const;

  geometry::TriangleMesh skin_L_;
  FaceTarget target_;
  std::vector<Anchor> anchors_;
  std::vector<std::vector<std::int32_t>> profile_triangles_;  ///< Of each profile.
  std::vector<std::vector<std::int32_t>> surface_vertices_;   ///< Of each surface.
  std::vector<std::vector<double>> surface_fractions_;        ///< Of these vertices; sum 1.
  std::vector<geometry::Bvh> surfaces_;
};

/// Root mean square of the residuals of one target [mm], the largest one, and their number.
struct TargetResidual {
  double rms_mm = 0.0, max_mm = 0.0;
  Index count = 0;
};

/// \returns one for each target. The residual of a landmark with three components is a distance.
[[nodiscard]] std::vector<TargetResidual> residuals_by_target(
    std::span<const Observation> observations, std::size_t target_count);

/// \returns J = 1/2 sum of weight times square [mm^2].
[[nodiscard]] double objective_mm2(std::span<const Observation> observations);

}  // namespace lefort::inverse
