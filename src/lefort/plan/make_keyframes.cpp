#include <lefort/core/units.h>
#include <lefort/geometry/fit_rigid.h>
#include <lefort/geometry/rigid_motion.h>
#include <lefort/plan/make_keyframes.h>

#include <fmt/format.h>

#include <cmath>

namespace lefort::plan {
namespace {

// Heuristic: surgical rotations are far smaller; exchanged sides of a triangle give 180 degrees.
constexpr double kMaxRotation_deg = 45.0;
constexpr double kRoundOff_mm = 1e-9;
constexpr int kMaxDays = 1000;  // As the number of steps in contract/plan.schema.json.

}  // namespace

geometry::Keyframe keyframe_of_pose(const RigidTransform& X_LB, const Vec3& center_L) {
  geometry::Keyframe key;
  key.rotation_rad = geometry::rotation_vector(X_LB.linear());
  key.center_L = center_L;
  key.translation_mm = X_LB * center_L - center_L;
  return key;
}

Result<geometry::Keyframe> keyframe_to_targets(std::span<const Landmark> landmarks,
                                               std::span<const Landmark> targets,
                                               double tolerance_mm) {
  const auto bad = [](std::string what) { return fail(ErrorCode::kPlanInvalid, std::move(what)); };
  std::vector<Vec3> from, to;
  Vec3 mean = Vec3::Zero();
  std::string names;
  for (const Landmark& target : targets) {
    names += (names.empty() ? "" : ", ") + target.name;
    const auto landmark = find_landmark(landmarks, target.name);
    if (!landmark) return bad(fmt::format("target {} has no landmark in the plan", target.name));
    from.push_back(*landmark);
    to.push_back(target.point_L);
    mean += *landmark / double(targets.size());
  }
  const auto fit = geometry::fit_rigid(from, to);
  if (!fit) return bad("targets: " + fit.error().message);
  if (!(fit->max_residual_mm <= tolerance_mm + kRoundOff_mm))
    return bad(fmt::format(
        "no rigid motion moves all landmarks to their targets: {} would miss its target by "
        "{:.2f} mm, at most {:g} mm are allowed",
        targets[std::size_t(fit->max_residual_index)].name, fit->max_residual_mm, tolerance_mm));
  const geometry::Keyframe key = keyframe_of_pose(fit->X_to_from, mean);
  const double rotation_deg = degrees_from_radians(key.rotation_rad.norm());
  if (!(rotation_deg <= kMaxRotation_deg))
    return bad(
        fmt::format("the targets of {} rotate the segment by {:.0f} degrees, at most {:g} are "
                    "allowed: are -R and -L exchanged?",
                    names, rotation_deg, kMaxRotation_deg));
  const auto sides = patient_left_axis(targets);
  if (!sides) return bad("targets: " + sides.error().message);
  return key;
}

Result<std::vector<geometry::Keyframe>> distraction_keyframes(
    std::span<const DistractionPhase> phases) {
  const auto bad = [](std::string what) { return fail(ErrorCode::kPlanInvalid, std::move(what)); };
  if (phases.empty()) return bad("`distraction` is empty, must have one phase or more");
  std::vector<geometry::Keyframe> keyframes;
  Vec3 translation_mm = Vec3::Zero();
  int days = 0;
  for (std::size_t i = 0; i < phases.size(); ++i) {
    const auto& [towards_L, mm_per_day, length] = phases[i];
    if (!towards_L.allFinite() || !(towards_L.norm() > 1e-9))
      return bad(fmt::format("distraction phase {}: its direction has no length", i));
    if (!(mm_per_day > 0.0) || !std::isfinite(mm_per_day))
      return bad(fmt::format("distraction phase {}: {} mm a day, must be above 0", i, mm_per_day));
    if (length < 1 || length > kMaxDays - days)
      return bad(
          fmt::format("distraction phase {}: {} days, must be 1 or more, and at most {} in "
                      "total",
                      i, length, kMaxDays));
    days += length;
    translation_mm += mm_per_day * double(length) * towards_L.normalized();
    geometry::Keyframe key;
    key.path_fraction = double(days);
    key.translation_mm = translation_mm;
    keyframes.push_back(key);
  }
  for (geometry::Keyframe& key : keyframes) key.path_fraction /= double(days);
  return keyframes;
}

int total_days(std::span<const DistractionPhase> phases) {
  int days = 0;
  for (const DistractionPhase& phase : phases) days += phase.days;
  return days;
}

}  // namespace lefort::plan
