#include <lefort/geometry/bvh.h>
#include <lefort/inverse/target_spec.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lefort::inverse {
namespace {

auto not_applicable(std::string message) {
  return fail(ErrorCode::kInvalidArgument, std::move(message));
}

Result<LandmarkTarget> apply(const LandmarkSpec& spec, const plan::Landmarks& landmarks) {
  LandmarkTarget target{.name = spec.name, .weight = spec.weight};
  const std::optional<Vec3> at_L =
      spec.at_L ? spec.at_L : plan::find_landmark(landmarks, spec.name);
  if (!at_L)
    return not_applicable(fmt::format(
        "landmark {} is not in the plan, and the target gives no at_mm for it", spec.name));
  target.point_L = *at_L;
  target.to_L = spec.to_L ? *spec.to_L : *at_L + spec.by_mm.value_or(Vec3::Zero());
  if (spec.towards_L) {
    target.direction_L = spec.towards_L->normalized();
    target.to_L = *at_L + spec.distance_mm * *target.direction_L;
  }
  return target;
}

/// y of the polyline at a height; of several crossings the most anterior.
std::optional<double> y_at(const std::vector<std::array<double, 2>>& line_mm, double z_mm) {
  std::optional<double> y_mm;
  for (std::size_t i = 0; i + 1 < line_mm.size(); ++i) {
    const auto [y0, z0] = line_mm[i];
    const auto [y1, z1] = line_mm[i + 1];
    if ((z0 - z_mm) * (z1 - z_mm) > 0.0) continue;
    const double t = z1 == z0 ? 0.0 : (z_mm - z0) / (z1 - z0);
    const double y = y0 + t * (y1 - y0);
    if (!y_mm || y < *y_mm) y_mm = y;
  }
  return y_mm;
}

/// Mean x of the landmarks without a side.
std::optional<double> midsagittal_x_mm(const plan::Landmarks& landmarks) {
  double sum = 0.0;
  int count = 0;
  for (const plan::Landmark& one : landmarks) {
    const plan::LandmarkKind* kind = plan::landmark_definition(one.name);
    if (kind == nullptr || kind->is_paired) continue;
    sum += one.point_L.x();
    ++count;
  }
  if (count == 0) return std::nullopt;
  return sum / count;
}

Result<ProfileTarget> apply(const ProfileSpec& spec, const geometry::Bvh& skin,
                            const plan::Landmarks& landmarks) {
  ProfileTarget target{.name = spec.name, .points = {}, .weight = spec.weight};
  const std::optional<double> x_mm = spec.x_mm ? spec.x_mm : midsagittal_x_mm(landmarks);
  if (!x_mm)
    return not_applicable(
        fmt::format("profile {}: x_mm of its plane is missing, and the plan has no "
                    "landmarks in the midsagittal plane",
                    spec.name));
  target.x_mm = *x_mm;
  for (const ProfilePointSpec& point : spec.points) {
    ProfilePoint wanted{.z_mm = point.z_mm, .y_mm = point.y_mm.value_or(0.0)};
    if (point.anterior_by_mm) {
      constexpr double kFar_mm = 1e4;
      const auto hit = skin.first_hit(Vec3(*x_mm, -kFar_mm, point.z_mm), Vec3::UnitY());
      if (!hit)
        return not_applicable(
            fmt::format("profile {}: there is no skin at the height {:g} mm in the plane "
                        "x = {:g} mm",
                        spec.name, point.z_mm, *x_mm));
      wanted.y_mm = hit->distance_mm - kFar_mm - *point.anterior_by_mm;
    }
    target.points.push_back(wanted);
  }
  if (!spec.polyline_mm.empty()) {
    double low = spec.polyline_mm.front()[1], high = low;
    for (const auto& [y, z] : spec.polyline_mm) {
      low = std::min(low, z);
      high = std::max(high, z);
    }
    const int steps = std::max(1, int(std::floor((high - low) / spec.spacing_mm)));
    for (int n = 0; n <= steps; ++n) {
      const double z_mm = low + (high - low) * (double(n) / steps);
      if (const auto y_mm = y_at(spec.polyline_mm, z_mm)) target.points.push_back({z_mm, *y_mm});
    }
  }
  if (target.points.empty())
    return not_applicable(fmt::format("profile {} has no points", spec.name));
  return target;
}

}  // namespace

Result<FaceTarget> apply_target(const TargetSpec& spec, const geometry::TriangleMesh& skin_L,
                                const plan::Landmarks& landmarks) {
  FaceTarget target;
  for (const LandmarkSpec& one : spec.landmarks) {
    LEFORT_TRY(target.landmarks.emplace_back(), apply(one, landmarks));
  }
  if (!spec.profiles.empty()) {
    const geometry::Bvh skin(skin_L);
    for (const ProfileSpec& one : spec.profiles) {
      LEFORT_TRY(target.profiles.emplace_back(), apply(one, skin, landmarks));
    }
  }
  target.surfaces = spec.surfaces;
  return target;
}

Result<std::vector<RigidBody>> bodies_of(const TargetSpec& spec,
                                         std::span<const geometry::RigidPath> paths,
                                         std::span<const Vec3> centers) {
  const std::vector<RigidTransform> X_LB = geometry::poses_at(paths, 1.0);
  std::vector<BodySpec> specs = spec.bodies;
  if (specs.empty())
    for (const geometry::RigidPath& path : paths)
      specs.push_back({.name = path.segment, .segments = {path.segment}});
  std::vector<std::string> owner(paths.size());
  std::vector<RigidBody> bodies;
  const auto add = [&](const BodySpec& of, const std::vector<std::size_t>& segments) {
    RigidBody& body = bodies.emplace_back();
    const std::size_t first = segments.front();
    const geometry::Keyframe& last = paths[first].keyframes.back();
    body.name = of.name;
    body.segments = segments;
    body.center_L = of.center_L                             ? *of.center_L
                    : last.rotation_rad.squaredNorm() > 0.0 ? last.center_L
                                                            : centers[first];
    body.start = motion_of(X_LB[first], body.center_L);
    for (const std::size_t k : segments)
      body.relative.push_back(of.relative == RelativePose::kPlan
                                  ? RigidTransform(X_LB[first].inverse() * X_LB[k])
                                  : RigidTransform::Identity());
    body.is_free = of.is_free.value_or(body.is_free);
    for (std::size_t i = 0; i < 6; ++i) {
      const auto row = Index(i);
      const double start = body.start[row];
      const auto bound = of.bounds[i].value_or(
          std::pair{std::min(-kDefaultBound, start), std::max(kDefaultBound, start)});
      body.lower[row] = bound.first;
      body.upper[row] = bound.second;
    }
  };
  for (const BodySpec& of : specs) {
    std::vector<std::size_t> segments;
    for (const std::string& name : of.segments) {
      const auto found = std::find_if(paths.begin(), paths.end(),
                                      [&](const auto& path) { return path.segment == name; });
      if (found == paths.end())
        return not_applicable(fmt::format("body {}: the plan has no segment {}", of.name, name));
      const auto k = std::size_t(found - paths.begin());
      if (!owner[k].empty())
        return not_applicable(
            fmt::format("segment {} belongs to the bodies {} and {}", name, owner[k], of.name));
      owner[k] = of.name;
      segments.push_back(k);
    }
    add(of, segments);
  }
  for (std::size_t k = 0; k < paths.size(); ++k)
    if (owner[k].empty()) add({.name = paths[k].segment, .is_free = std::array<bool, 6>{}}, {k});
  return bodies;
}

}  // namespace lefort::inverse
