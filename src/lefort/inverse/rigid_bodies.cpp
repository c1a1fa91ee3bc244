#include <lefort/core/check.h>
#include <lefort/core/units.h>
#include <lefort/inverse/rigid_bodies.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace lefort::inverse {
namespace {

constexpr double kRadPerDeg = radians_from_degrees(1.0);

Result<void> check_body(const RigidBody& body) {
  for (std::size_t i = 0; i < 6; ++i) {
    const auto row = Index(i);
    const double low = body.lower[row], high = body.upper[row], start = body.start[row];
    if (!std::isfinite(low) || !std::isfinite(high) || !std::isfinite(start))
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("body {}: {} is not finite", body.name, kMotionNames[i]));
    if (low > high)
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("body {}: the bounds of {} contradict each other, {:g} > {:g}",
                              body.name, kMotionNames[i], low, high));
    if (!body.is_free[i] && (start < low || start > high))
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("body {}: {} is not free, and its value in the plan, {:g}, lies "
                              "outside its bounds {:g} to {:g}",
                              body.name, kMotionNames[i], start, low, high));
  }
  return {};
}

}  // namespace

geometry::Keyframe keyframe_of(const MotionVector& motion, const Vec3& center_L) {
  return {.translation_mm = Vec3(motion[0], -motion[1], motion[2]),
          .rotation_rad = kRadPerDeg * Vec3(-motion[3], -motion[4], motion[5]),
          .center_L = center_L};
}

MotionVector motion_of(const RigidTransform& X_LB, const Vec3& center_L) {
  const Vec3 shift = X_LB * center_L - center_L;
  const Vec3 turn_deg = geometry::rotation_vector(X_LB.linear()) / kRadPerDeg;
  MotionVector motion;
  motion << shift.x(), -shift.y(), shift.z(), -turn_deg.x(), -turn_deg.y(), turn_deg.z();
  return motion;
}

Result<MotionVariables> MotionVariables::create(std::vector<RigidBody> bodies,
                                                std::size_t segment_count) {
  MotionVariables variables;
  variables.segment_count_ = segment_count;
  std::vector<double> start, lower, upper;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const RigidBody& body = bodies[b];
    LEFORT_CHECK(!body.segments.empty() && body.relative.size() == body.segments.size());
    LEFORT_TRY_VOID(check_body(body));
    for (std::size_t i = 0; i < 6; ++i) {
      const auto row = Index(i);
      if (!body.is_free[i] || body.lower[row] == body.upper[row]) continue;
      variables.numbers_.emplace_back(b, row);
      start.push_back(std::clamp(body.start[row], body.lower[row], body.upper[row]));
      lower.push_back(body.lower[row]);
      upper.push_back(body.upper[row]);
    }
    for (Index i = 0; i < 6; ++i)
      bodies[b].start[i] = std::clamp(body.start[i], body.lower[i], body.upper[i]);
  }
  if (variables.numbers_.empty())
    return fail(ErrorCode::kInvalidArgument,
                "no number of any movement is free: nothing can be optimized");
  const auto as_vector = [](const std::vector<double>& values) {
    return VectorX(Eigen::Map<const VectorX>(values.data(), Index(values.size())));
  };
  variables.start_ = as_vector(start);
  variables.lower_ = as_vector(lower);
  variables.upper_ = as_vector(upper);
  variables.bodies_ = std::move(bodies);
  return variables;
}

std::string MotionVariables::name(Index number) const {
  const auto [body, component] = numbers_[std::size_t(number)];
  return fmt::format("{} {}", bodies_[body].name, kMotionNames[std::size_t(component)]);
}

const char* MotionVariables::unit(Index number) const {
  return numbers_[std::size_t(number)].second < 3 ? "mm" : "deg";
}

std::vector<MotionVector> MotionVariables::motions(const VectorX& x) const {
  LEFORT_CHECK(x.size() == count());
  std::vector<MotionVector> motions;
  for (const RigidBody& body : bodies_) motions.push_back(body.start);
  for (std::size_t n = 0; n < numbers_.size(); ++n)
    motions[numbers_[n].first][numbers_[n].second] = x[Index(n)];
  return motions;
}

std::vector<RigidTransform> MotionVariables::poses(const VectorX& x) const {
  std::vector<RigidTransform> X_LB(segment_count_, RigidTransform::Identity());
  const std::vector<MotionVector> motion = motions(x);
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const geometry::Keyframe key = keyframe_of(motion[b], bodies_[b].center_L);
    const RigidTransform first =
        geometry::rigid_motion(key.translation_mm, key.rotation_rad, key.center_L);
    for (std::size_t k = 0; k < bodies_[b].segments.size(); ++k)
      X_LB[bodies_[b].segments[k]] = k == 0 ? first : first * bodies_[b].relative[k];
  }
  return X_LB;
}

std::vector<predict::PoseRate> MotionVariables::rates(const VectorX& x) const {
  const std::vector<MotionVector> motion = motions(x);
  std::vector<predict::PoseRate> all;
  for (const auto& [b, component] : numbers_) {
    const RigidBody& body = bodies_[b];
    const geometry::Keyframe key = keyframe_of(motion[b], body.center_L);
    geometry::MotionRate rate = geometry::motion_rates(key.translation_mm, key.rotation_rad,
                                                       key.center_L)[std::size_t(component)];
    if (component == 1) rate.translation *= -1.0;  // Anterior is -y.
    if (component == 3 || component == 4) rate.rotation_rad *= -1.0;
    rate.rotation_rad *= kRadPerDeg;
    predict::PoseRate& of = all.emplace_back();
    for (const std::size_t segment : body.segments) of.emplace_back(segment, rate);
  }
  return all;
}

}  // namespace lefort::inverse
