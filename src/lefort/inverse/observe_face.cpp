#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/inverse/observe_face.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace lefort::inverse {
namespace {

/// Skin can move this far across the plane of a profile.
constexpr double kProfileReach_mm = 20.0;

/// Barycentric coordinates of a point in the plane of a triangle.
Vec3 weights_at(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = (b - a).cross(c - a);
  const double squared = normal.squaredNorm();
  if (!(squared > 0.0)) return Vec3::Constant(1.0 / 3.0);
  const double beta = (p - a).cross(c - a).dot(normal) / squared;
  const double gamma = (b - a).cross(p - a).dot(normal) / squared;
  return {1.0 - beta - gamma, beta, gamma};
}

/// Vertices on an edge of one triangle only.
std::vector<char> border_vertices(const geometry::TriangleMesh& mesh) {
  std::map<std::pair<std::int32_t, std::int32_t>, int> uses;
  for (const geometry::Triangle& t : mesh.triangles)
    for (std::size_t n = 0; n < 3; ++n) ++uses[std::minmax({t[n], t[(n + 1) % 3]})];
  std::vector<char> is_border(mesh.vertices.size(), 0);
  for (const auto& [edge, count] : uses)
    if (count == 1) is_border[std::size_t(edge.first)] = is_border[std::size_t(edge.second)] = 1;
  return is_border;
}

/// Whether a closest point lies on a vertex of the border or on an edge between two.
bool is_on_border(const geometry::TriangleMesh& mesh, const std::vector<char>& is_border,
                  const geometry::SurfacePoint& nearest) {
  constexpr double kOnEdge = 1e-9;  // Barycentric coordinate.
  const geometry::Triangle& t = mesh.triangles[std::size_t(nearest.triangle)];
  const auto at = [&](std::size_t n) { return mesh.vertices[std::size_t(t[n])]; };
  const Vec3 weights = weights_at(nearest.point, at(0), at(1), at(2));
  for (std::size_t n = 0; n < 3; ++n)
    if (is_border[std::size_t(t[n])] == 0 && weights[Index(n)] > kOnEdge) return false;
  return is_border[std::size_t(t[0])] != 0 || is_border[std::size_t(t[1])] != 0 ||
         is_border[std::size_t(t[2])] != 0;
}

auto invalid(std::string message) { return fail(ErrorCode::kInvalidArgument, std::move(message)); }

}  // namespace

Result<FaceObserver> FaceObserver::create(geometry::TriangleMesh skin_L,
                                          std::span<const char> is_moved, FaceTarget target) {
  LEFORT_CHECK(is_moved.size() == skin_L.vertices.size());
  FaceObserver observer(std::move(skin_L), std::move(target));
  const FaceTarget& of = observer.target_;
  double weight = 0.0;
  for (const LandmarkTarget& one : of.landmarks) weight += one.weight;
  for (const ProfileTarget& one : of.profiles) weight += one.weight;
  for (const SurfaceTarget& one : of.surfaces) weight += one.weight;
  if (!(weight > 0.0)) return invalid("no target has a positive weight");
  LEFORT_TRY_VOID(observer.anchor_landmarks(is_moved));
  LEFORT_TRY_VOID(observer.check_profiles(is_moved));
  LEFORT_TRY_VOID(observer.choose_vertices(is_moved));
  return observer;
}

Result<void> FaceObserver::anchor_landmarks(std::span<const char> is_moved) {
  if (target_.landmarks.empty()) return {};
  const geometry::Bvh skin(skin_L_);
  for (const LandmarkTarget& of : target_.landmarks) {
    const auto nearest = skin.closest_point(of.point_L, kMaxLandmarkDistance_mm);
    if (!nearest)
      return invalid(fmt::format("landmark {} lies more than {:g} mm from the skin", of.name,
                                 kMaxLandmarkDistance_mm));
    const geometry::Triangle& corners = skin_L_.triangles[std::size_t(nearest->triangle)];
    const auto at = [&](std::size_t n) { return skin_L_.vertices[std::size_t(corners[n])]; };
    if (std::none_of(corners.begin(), corners.end(),
                     [&](std::int32_t v) { return is_moved[std::size_t(v)] != 0; }))
      return invalid(fmt::format(
          "landmark {} lies outside the meshed tissue, which no segment moves there", of.name));
    const double motion_mm = of.direction_L ? std::abs(of.direction_L->dot(of.to_L - of.point_L))
                                            : (of.to_L - of.point_L).norm();
    if (motion_mm > kMaxMotion_mm)
      return invalid(
          fmt::format("landmark {} would move by {:.0f} mm; at most {:g} mm are possible", of.name,
                      motion_mm, kMaxMotion_mm));
    anchors_.push_back({corners, weights_at(nearest->point, at(0), at(1), at(2))});
  }
  return {};
}

std::vector<std::int32_t> FaceObserver::triangles_near(double x_mm) const {
  std::vector<std::int32_t> near;
  for (std::size_t t = 0; t < skin_L_.triangles.size(); ++t)
    for (const std::int32_t v : skin_L_.triangles[t])
      if (std::abs(skin_L_.vertices[std::size_t(v)].x() - x_mm) < kProfileReach_mm) {
        near.push_back(std::int32_t(t));
        break;
      }
  return near;
}

Result<void> FaceObserver::check_profiles(std::span<const char> is_moved) {
  const std::vector<Vec3> rest(skin_L_.vertices.size(), Vec3::Zero());
  for (const ProfileTarget& of : target_.profiles) {
    profile_triangles_.push_back(triangles_near(of.x_mm));
    bool is_any_moved = false;
    for (const ProfilePoint& point : of.points) {
      const auto hit = hit_at(rest, profile_triangles_.back(), of.x_mm, point.z_mm);
      if (!hit)
        return invalid(
            fmt::format("profile {}: there is no skin at the height {:g} mm in the plane "
                        "x = {:g} mm",
                        of.name, point.z_mm, of.x_mm));
      if (std::abs(hit->y_mm - point.y_mm) > kMaxMotion_mm)
        return invalid(
            fmt::format("profile {}: the skin at the height {:g} mm would move by {:.0f} "
                        "mm; at most {:g} mm are possible",
                        of.name, point.z_mm, std::abs(hit->y_mm - point.y_mm), kMaxMotion_mm));
      for (const std::int32_t v : skin_L_.triangles[std::size_t(hit->triangle)])
        is_any_moved = is_any_moved || is_moved[std::size_t(v)] != 0;
    }
    if (!is_any_moved)
      return invalid(fmt::format(
          "profile {} lies outside the meshed tissue, which no segment moves there", of.name));
  }
  return {};
}

Result<void> FaceObserver::choose_vertices(std::span<const char> is_moved) {
  std::vector<double> areas_mm2(skin_L_.vertices.size(), 0.0);
  for (const geometry::Triangle& t : skin_L_.triangles) {
    const auto at = [&](std::size_t n) { return skin_L_.vertices[std::size_t(t[n])]; };
    const double third_mm2 = (at(1) - at(0)).cross(at(2) - at(0)).norm() / 6.0;
    for (const std::int32_t v : t) areas_mm2[std::size_t(v)] += third_mm2;
  }
  for (const SurfaceTarget& of : target_.surfaces)
    LEFORT_TRY_VOID(choose_vertices(of, is_moved, areas_mm2));
  return {};
}

Result<void> FaceObserver::choose_vertices(const SurfaceTarget& of, std::span<const char> is_moved,
                                           std::span<const double> areas_mm2) {
  if (of.surface_L.triangles.empty())
    return invalid(fmt::format("surface {} has no triangles", of.name));
  const geometry::Bvh& surface = surfaces_.emplace_back(of.surface_L);
  const std::vector<char> is_border = border_vertices(surface.mesh());
  auto& vertices = surface_vertices_.emplace_back();
  auto& fractions = surface_fractions_.emplace_back();
  double all_mm2 = 0.0, near_mm2 = 0.0, chosen_mm2 = 0.0;
  for (std::size_t v = 0; v < skin_L_.vertices.size(); ++v) {
    if (is_moved[v] == 0 || (of.region_L && !of.region_L->contains(skin_L_.vertices[v]))) continue;
    all_mm2 += areas_mm2[v];
    const auto nearest = surface.closest_point(skin_L_.vertices[v], of.max_distance_mm);
    if (!nearest) continue;
    near_mm2 += areas_mm2[v];
    if (is_on_border(surface.mesh(), is_border, *nearest)) continue;
    vertices.push_back(std::int32_t(v));
    fractions.push_back(areas_mm2[v]);
    chosen_mm2 += areas_mm2[v];
  }
  if (!(all_mm2 > 0.0))
    return invalid(
        fmt::format("surface {}: no skin that a segment can move lies in its region", of.name));
  if (near_mm2 < kMinOverlap * all_mm2 || !(chosen_mm2 > 0.0))
    return invalid(fmt::format(
        "surface {} is close to {:.0f} % of the skin in its region only: is it of another patient "
        "or in another frame? At least {:.0f} % must lie within {:g} mm of it",
        of.name, 100.0 * near_mm2 / all_mm2, 100.0 * kMinOverlap, of.max_distance_mm));
  for (double& fraction : fractions) fraction /= chosen_mm2;
  return {};
}

std::optional<FaceObserver::Hit> FaceObserver::hit_at(std::span<const Vec3> displacement_mm,
                                                      std::span<const std::int32_t> triangles,
                                                      double x_mm, double z_mm) const {
  std::optional<Hit> first;
  for (const std::int32_t t : triangles) {
    std::array<Vec3, 3> p;
    for (std::size_t n = 0; n < 3; ++n) {
      const auto v = std::size_t(skin_L_.triangles[std::size_t(t)][n]);
      p[n] = skin_L_.vertices[v] + displacement_mm[v];
    }
    // Twice the signed areas in the plane (x, z) of the triangles of the ray and each edge.
    const auto edge = [&](const Vec3& a, const Vec3& b) {
      return (a.x() - x_mm) * (b.z() - z_mm) - (b.x() - x_mm) * (a.z() - z_mm);
    };
    const Vec3 areas(edge(p[1], p[2]), edge(p[2], p[0]), edge(p[0], p[1]));
    const double sum = areas.sum();
    if (sum == 0.0 || (areas.array() * sum < 0.0).any()) continue;
    const Vec3 weights = areas / sum;
    const double y_mm = weights.dot(Vec3(p[0].y(), p[1].y(), p[2].y()));
    if (!first || y_mm < first->y_mm) first = Hit{y_mm, t, weights};
  }
  return first;
}

std::vector<std::optional<double>> FaceObserver::profile_y_mm(std::span<const Vec3> displacement_mm,
                                                              double x_mm,
                                                              std::span<const double> z_mm) const {
  const std::vector<std::int32_t> triangles = triangles_near(x_mm);
  std::vector<std::optional<double>> y_mm(z_mm.size());
  parallel_for(Index(z_mm.size()), [&](Index n) {
    if (const auto hit = hit_at(displacement_mm, triangles, x_mm, z_mm[std::size_t(n)]))
      y_mm[std::size_t(n)] = hit->y_mm;
  });
  return y_mm;
}

void FaceObserver::observe_landmarks(std::span<const Vec3> displacement_mm,
                                     std::vector<Observation>& all) const {
  for (std::size_t k = 0; k < anchors_.size(); ++k) {
    const LandmarkTarget& of = target_.landmarks[k];
    const Anchor& anchor = anchors_[k];
    Vec3 x_L = Vec3::Zero();
    for (Index n = 0; n < 3; ++n)
      x_L += anchor.weights[n] * position(anchor.vertices[std::size_t(n)], displacement_mm);
    const auto add = [&](const Vec3& direction) {
      Observation one{.residual_mm = direction.dot(x_L - of.to_L),
                      .weight = of.weight,
                      .target = k,
                      .components = of.direction_L ? 1 : 3,
                      .at_L = x_L,
                      .vertices = anchor.vertices};
      for (Index n = 0; n < 3; ++n) one.gradient[std::size_t(n)] = anchor.weights[n] * direction;
      all.push_back(one);
    };
    if (of.direction_L) add(*of.direction_L);
    for (Index axis = 0; !of.direction_L && axis < 3; ++axis) add(Vec3::Unit(axis));
  }
}

void FaceObserver::observe_profile(std::size_t profile, std::span<const Vec3> displacement_mm,
                                   std::vector<Observation>& all) const {
  const ProfileTarget& of = target_.profiles[profile];
  const std::size_t first_one = all.size();
  const double fraction = 1.0 / double(of.points.size());
  all.resize(first_one + of.points.size());
  parallel_for(Index(of.points.size()), [&](Index i) {
    const ProfilePoint& point = of.points[std::size_t(i)];
    Observation& one = all[first_one + std::size_t(i)];
    one = {.residual_mm = kMaxMotion_mm,
           .weight = of.weight * fraction,
           .fraction = fraction,
           .target = anchors_.size() + profile,
           .at_L = Vec3(of.x_mm, point.y_mm, point.z_mm)};
    const auto hit = hit_at(displacement_mm, profile_triangles_[profile], of.x_mm, point.z_mm);
    if (!hit) return;
    const geometry::Triangle& corners = skin_L_.triangles[std::size_t(hit->triangle)];
    const Vec3 first = position(corners[0], displacement_mm);
    const Vec3 normal = (position(corners[1], displacement_mm) - first)
                            .cross(position(corners[2], displacement_mm) - first);
    if (normal.y() == 0.0) return;
    one.residual_mm = hit->y_mm - point.y_mm;
    one.at_L.y() = hit->y_mm;
    one.vertices = corners;
    for (Index n = 0; n < 3; ++n)
      one.gradient[std::size_t(n)] = hit->weights[n] / normal.y() * normal;
  });
}

void FaceObserver::observe_surface(std::size_t surface, std::span<const Vec3> displacement_mm,
                                   std::vector<Observation>& all) const {
  const SurfaceTarget& of = target_.surfaces[surface];
  const std::vector<std::int32_t>& vertices = surface_vertices_[surface];
  const std::size_t first_one = all.size();
  all.resize(first_one + vertices.size());
  parallel_for(Index(vertices.size()), [&](Index i) {
    const std::int32_t v = vertices[std::size_t(i)];
    const double fraction = surface_fractions_[surface][std::size_t(i)];
    Observation& one = all[first_one + std::size_t(i)];
    one = {.residual_mm = of.max_distance_mm,
           .weight = of.weight * fraction,
           .fraction = fraction,
           .target = anchors_.size() + target_.profiles.size() + surface,
           .at_L = position(v, displacement_mm),
           .vertices = {v, v, v}};
    if (!surfaces_[surface].closest_point(one.at_L, of.max_distance_mm)) return;
    const geometry::SignedDistance at = surfaces_[surface].signed_distance(one.at_L);
    constexpr double kOnSurface_mm = 1e-9;
    one.residual_mm = at.distance_mm;
    one.gradient[0] = std::abs(at.distance_mm) > kOnSurface_mm
                          ? Vec3((one.at_L - at.nearest.point) / at.distance_mm)
                          : at.pseudonormal.normalized();
  });
}

std::vector<Observation> FaceObserver::observe(std::span<const Vec3> displacement_mm) const {
  LEFORT_CHECK(displacement_mm.size() == skin_L_.vertices.size());
  std::vector<Observation> all;
  observe_landmarks(displacement_mm, all);
  for (std::size_t k = 0; k < target_.profiles.size(); ++k)
    observe_profile(k, displacement_mm, all);
  for (std::size_t k = 0; k < target_.surfaces.size(); ++k)
    observe_surface(k, displacement_mm, all);
  return all;
}

std::vector<TargetResidual> residuals_by_target(std::span<const Observation> observations,
                                                std::size_t target_count) {
  std::vector<TargetResidual> all(target_count);
  std::vector<double> fractions(target_count, 0.0), squares(target_count, 0.0);
  for (std::size_t i = 0; i < observations.size(); i += std::size_t(observations[i].components)) {
    const Observation& first = observations[i];
    TargetResidual& of = all[first.target];
    double squared = 0.0;
    for (std::size_t c = 0; c < std::size_t(first.components); ++c)
      squared += observations[i + c].residual_mm * observations[i + c].residual_mm;
    ++of.count;
    fractions[first.target] += first.fraction;
    squares[first.target] += first.fraction * squared;
    of.max_mm = std::max(of.max_mm, std::sqrt(squared));
  }
  for (std::size_t k = 0; k < target_count; ++k)
    if (fractions[k] > 0.0) all[k].rms_mm = std::sqrt(squares[k] / fractions[k]);
  return all;
}

double objective_mm2(std::span<const Observation> observations) {
  double sum = 0.0;
  for (const Observation& one : observations)
    sum += 0.5 * one.weight * one.residual_mm * one.residual_mm;
  return sum;
}

}  // namespace lefort::inverse
