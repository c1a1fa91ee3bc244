/// \file
/// A target as its file states it, before it is applied to a patient; and how it is applied.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/inverse/rigid_bodies.h>
#include <lefort/inverse/target.h>
#include <lefort/plan/landmarks.h>

#include <array>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace lefort::inverse {

/// One of `to_L`, `by_mm`, or `towards_L` with `distance_mm`.
struct LandmarkSpec {
  std::string name;
  std::optional<Vec3> at_L{};  ///< Before surgery; empty: the plan's landmark of that name.
  std::optional<Vec3> to_L{};
  std::optional<Vec3> by_mm{};
  std::optional<Vec3> towards_L{};  ///< Not zero; any length.
  double distance_mm = 0.0;         ///< Along towards_L.
  double weight = 1.0;
};

/// One of `y_mm` and `anterior_by_mm`.
struct ProfilePointSpec {
  double z_mm = 0.0;
  std::optional<double> y_mm{};
  std::optional<double> anterior_by_mm{};  ///< From the profile before surgery.
};

struct ProfileSpec {
  std::string name = "profile";
  std::optional<double> x_mm{};  ///< Plane; empty: the midsagittal plane of the landmarks.
  std::vector<ProfilePointSpec> points{};
  std::vector<std::array<double, 2>> polyline_mm{};  ///< y and z of the wanted profile.
  double spacing_mm = 2.0;                           ///< Between heights on the polyline, > 0.
  double weight = 1.0;
};

enum class RelativePose {
  kPlan,  ///< As in the given plan: its final occlusion, the splint.
  kScan,  ///< As in the scan.
};

struct BodySpec {
  std::string name{};
  std::vector<std::string> segments{};  ///< One or more.
  RelativePose relative = RelativePose::kPlan;
  std::optional<Vec3> center_L{};  ///< Empty: the rotation center of the plan's last keyframe.
  std::optional<std::array<bool, 6>> is_free{};                      ///< Empty: all.
  std::array<std::optional<std::pair<double, double>>, 6> bounds{};  ///< Empty: kDefaultBound.
};

inline constexpr double kDefaultBound = 20.0;  ///< [mm, degrees]

struct TargetSpec {
  std::string title{};
  std::vector<LandmarkSpec> landmarks{};
  std::vector<ProfileSpec> profiles{};
  std::vector<SurfaceTarget> surfaces{};
  std::vector<BodySpec> bodies{};  ///< Empty: each segment alone, all numbers free.
  double overlap_mm = 0.5;         ///< Max depth of bone overlap.
  double regularization = 0.0;
};

/// \param skin_L     before surgery.
/// \param landmarks  of the plan.
/// \returns the target; or kInvalidArgument, naming it, if a landmark is not in the plan, the plane
///   of a profile is not known, or there is no skin at a height.
[[nodiscard]] Result<FaceTarget> apply_target(const TargetSpec& spec,
                                              const geometry::TriangleMesh& skin_L,
                                              const plan::Landmarks& landmarks);

/// \param paths    of the segments in the given plan.
/// \param centers  of rotation of segments that do not rotate in the plan: their centroids.
/// \returns the bodies, starting at the end of the paths. Segments of no body stay there. Or
///   kInvalidArgument if a segment does not exist or belongs to two bodies.
[[nodiscard]] Result<std::vector<RigidBody>> bodies_of(const TargetSpec& spec,
                                                       std::span<const geometry::RigidPath> paths,
                                                       std::span<const Vec3> centers);

}  // namespace lefort::inverse
