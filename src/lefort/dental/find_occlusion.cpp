#include <lefort/core/decompositions.h>
#include <lefort/core/parallel.h>
#include <lefort/core/units.h>
#include <lefort/dental/beyond_border.h>
#include <lefort/dental/find_occlusion.h>
#include <lefort/geometry/bvh.h>
#include <lefort/geometry/mesh_properties.h>
#include <lefort/geometry/rigid_motion.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>

namespace lefort::dental {
namespace {

using geometry::Bvh;
using geometry::TriangleMesh;
using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;

constexpr double kReach_mm = 10.0;
constexpr double kShownGap_mm = 3.0;
constexpr Index kMinFacing = 50;
/// Further away, the search has left the teeth of its start.
constexpr double kMaxMovement_mm = 9.0;
/// Makes rotations comparable with translations: half the width of an arch.
constexpr double kArch_mm = 25.0;

/// A stage of the minimization: width of the weights, and penalty of penetration.
struct Stage {
  double width_mm = 0.0;
  double penalty = 1.0;
  int iterations = 0;
  bool tilts = true;  ///< Whether the arch may rotate out of the occlusal plane.
};
constexpr std::array<Stage, 5> kCoarse{
    {{6.0, 1.0, 15, false}, {4.0, 1.0, 10, false}, {2.0, 1.0, 8}, {1.0, 4.0, 8}, {0.5, 10.0, 8}}};
constexpr std::array<Stage, 3> kFine{{{0.5, 10.0, 15}, {0.25, 40.0, 20}, {0.15, 300.0, 30}}};

/// A point of an arch and the area around it.
struct ArchPoint {
  Vec3 point, normal;
  double mm2 = 0.0;
};

/// Every n-th vertex; the area of the others goes with it. Those that do not face `occlusal` within
/// 60 degrees are left out: they touch nothing.
std::vector<ArchPoint> points_of(const TriangleMesh& mesh, const Vec3& occlusal, Index maximum) {
  const geometry::Pseudonormals normals(mesh);
  std::vector<double> mm2(mesh.vertices.size(), 0.0);
  for (Index t = 0; t < mesh.triangle_count(); ++t) {
    const Vec3& a = mesh.corner(t, 0);
    const double third = (mesh.corner(t, 1) - a).cross(mesh.corner(t, 2) - a).norm() / 6.0;
    for (const std::int32_t v : mesh.triangles[std::size_t(t)]) mm2[std::size_t(v)] += third;
  }
  const Index stride = std::max<Index>((mesh.vertex_count() + maximum - 1) / maximum, 1);
  std::vector<ArchPoint> points;
  for (Index v = 0; v < mesh.vertex_count(); v += stride) {
    const Vec3 normal = normals.at_vertex(mesh, v);
    if (normal.dot(occlusal) > 0.5)
      points.push_back(
          {mesh.vertices[std::size_t(v)], normal, double(stride) * mm2[std::size_t(v)]});
  }
  return points;
}

/// An arch: its surface and its points.
struct Arch {
  Bvh tree;
  std::vector<ArchPoint> few, many;

  Arch(const TriangleMesh& mesh, const Vec3& occlusal)
      : tree(mesh), few(points_of(mesh, occlusal, 1500)), many(points_of(mesh, occlusal, 10000)) {}
};

/// The gap of a point over a surface that faces it.
struct FacedGap {
  double gap_mm = 0.0;  ///< Negative: the point penetrates the surface.
  Vec3 point, normal;   ///< Of the surface.
};

/// \param p, n  point and its normal in the frame of the surface.
std::optional<FacedGap> gap_over(const Bvh& surface, const Vec3& p, const Vec3& n, double reach) {
  const auto nearest = surface.closest_point(p, reach);
  if (!nearest) return std::nullopt;
  const Vec3 there =
      surface.pseudonormals().at(surface.mesh(), nearest->triangle, nearest->feature).normalized();
  if (!(there.dot(n) < -0.2)) return std::nullopt;
  const Vec3 offset = p - nearest->point;
  if (is_beyond_border(offset, there)) return std::nullopt;
  return FacedGap{there.dot(offset), nearest->point, there};
}

/// Weight of a gap: Geman and McClure's for open gaps, the penalty for penetration.
double weight_of(double gap_mm, const Stage& stage) {
  if (gap_mm < 0.0) return stage.penalty;
  const double w2 = stage.width_mm * stage.width_mm;
  const double r = w2 / (w2 + gap_mm * gap_mm);
  return r * r;
}

/// Normal equations of one step of (rotation times kArch_mm, translation) of the lower arch.
struct GapSums {
  Mat6 matrix = Mat6::Zero();
  Vec6 vector = Vec6::Zero();
  Index facing = 0;
  Mat3 rotations = Mat3::Identity();  ///< Projection onto the rotations that are free.

  GapSums& operator+=(const GapSums& other) {
    matrix += other.matrix;
    vector += other.vector;
    facing += other.facing;
    return *this;
  }
  /// \param direction  of the change of the gap as `moved` moves.
  void add(double weight, double gap_mm, const Vec3& moved, const Vec3& direction,
           const Vec3& center) {
    Vec6 row;
    row << rotations * (moved - center).cross(direction) / kArch_mm, direction;
    matrix += weight * row * row.transpose();
    vector += weight * gap_mm * row;
    ++facing;
  }
};

GapSums sum_gaps(const Arch& upper, const Arch& lower, bool all, const RigidTransform& X,
                 const Vec3& center, const Vec3& superior_L, const Stage& stage) {
  const auto& from_lower = all ? lower.many : lower.few;
  const auto& from_upper = all ? upper.many : upper.few;
  const RigidTransform back = X.inverse();
  const auto count = Index(from_lower.size());
  const Mat3 rotations =
      stage.tilts ? Mat3(Mat3::Identity()) : Mat3(superior_L * superior_L.transpose());
  return deterministic_sum(count + Index(from_upper.size()), GapSums{}, [&](Index i) {
    GapSums one;
    one.rotations = rotations;
    if (i < count) {
      const ArchPoint& at = from_lower[std::size_t(i)];
      const Vec3 p = X * at.point;
      if (const auto faced = gap_over(upper.tree, p, X.linear() * at.normal, kReach_mm))
        one.add(at.mm2 * weight_of(faced->gap_mm, stage), faced->gap_mm, p, faced->normal, center);
      return one;
    }
    const ArchPoint& at = from_upper[std::size_t(i - count)];
    if (const auto faced =
            gap_over(lower.tree, back * at.point, back.linear() * at.normal, kReach_mm))
      one.add(at.mm2 * weight_of(faced->gap_mm, stage), faced->gap_mm, X * faced->point,
              -(X.linear() * faced->normal), center);
    return one;
  });
}

/// Minimizes in stages. \returns nothing if the arches do not face each other.
std::optional<RigidTransform> minimize(const Arch& upper, const Arch& lower, bool all,
                                       RigidTransform X, const Vec3& center_of_lower,
                                       const Vec3& superior_L, std::span<const Stage> stages) {
  constexpr double kMaxStep_mm = 2.0, kEnough_mm = 1e-4, kRidge = 1e-6;
  for (const Stage& stage : stages)
    for (int n = 0; n < stage.iterations; ++n) {
      const Vec3 center = X * center_of_lower;
      GapSums sums = sum_gaps(upper, lower, all, X, center, superior_L, stage);
      if (sums.facing < kMinFacing) return std::nullopt;
      sums.matrix += kRidge * sums.matrix.trace() * Mat6::Identity();
      Vec6 step = -sums.matrix.ldlt().solve(sums.vector);
      if (!step.allFinite()) return std::nullopt;
      if (step.norm() > kMaxStep_mm) step *= kMaxStep_mm / step.norm();
      X = geometry::rigid_motion(step.tail<3>(), step.head<3>() / kArch_mm, center) * X;
      if (step.norm() < kEnough_mm) break;
    }
  return X;
}

/// Largest distance between two positions of the lower arch, at its middle and its ends.
double distance_between(const RigidTransform& a, const RigidTransform& b, const Vec3& center,
                        const ArchAxes& axes) {
  double max_mm = 0.0;
  for (const Vec3& arm : {Vec3(kArch_mm * axes.anterior_L), Vec3(kArch_mm * axes.left_L()),
                          Vec3(-kArch_mm * axes.left_L())})
    max_mm = std::max(max_mm, (a * (center + arm) - b * (center + arm)).norm());
  return max_mm;
}

/// Area of the occlusal surfaces of both arches that faces the other one, weighted by
/// w^2 / (w^2 + g^2); less where they penetrate. Area that faces nothing counts nothing: otherwise
/// arches that touch at few teeth would seem closer than those in occlusion.
double facing_mm2(const Arch& upper, const Arch& lower, const RigidTransform& X) {
  constexpr double kWidth_mm = 1.5, kPenetration_mm = 0.3;
  const RigidTransform back = X.inverse();
  const auto count = Index(lower.few.size());
  return deterministic_sum(count + Index(upper.few.size()), 0.0, [&](Index i) {
    const bool is_lower = i < count;
    const ArchPoint& at = is_lower ? lower.few[std::size_t(i)] : upper.few[std::size_t(i - count)];
    const RigidTransform& to = is_lower ? X : back;
    const auto faced = gap_over(is_lower ? upper.tree : lower.tree, to * at.point,
                                to.linear() * at.normal, kReach_mm);
    if (!faced) return 0.0;
    const double r = faced->gap_mm / (faced->gap_mm < 0.0 ? kPenetration_mm : kWidth_mm);
    return at.mm2 * (faced->gap_mm < 0.0 ? 1.0 - std::min(r * r, 4.0) : 1.0 / (1.0 + r * r));
  });
}

std::vector<RigidTransform> starts_of(const ArchAxes& axes, const OcclusionOptions& options,
                                      const Vec3& center) {
  std::vector<RigidTransform> starts;
  for (const double ahead : {-1.0, 0.0, 1.0})
    for (const double aside : {-1.0, 0.0, 1.0})
      for (const double yaw : {-1.0, 0.0, 1.0})
        starts.push_back(geometry::rigid_motion(
            options.shift_mm * (ahead * axes.anterior_L + aside * axes.left_L()),
            radians_from_degrees(yaw * options.yaw_deg) * axes.superior_L, center));
  return starts;
}

Vec3 mean_of(const std::vector<Vec3>& points) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& p : points) sum += p / double(points.size());
  return sum;
}

/// Deepest penetration of the vertices of `points` into `surface`, up to kReach_mm.
double penetration_mm(const TriangleMesh& points, const Bvh& surface, const RigidTransform& X) {
  const geometry::Pseudonormals normals(points);
  std::vector<double> depths(points.vertices.size(), 0.0);
  parallel_for(points.vertex_count(), [&](Index v) {
    const auto faced = gap_over(surface, X * points.vertices[std::size_t(v)],
                                X.linear() * normals.at_vertex(points, v), kReach_mm);
    if (faced) depths[std::size_t(v)] = std::max(-faced->gap_mm, 0.0);
  });
  return depths.empty() ? 0.0 : *std::max_element(depths.begin(), depths.end());
}

/// Opens the arches along the superior direction until the penetration is within its limit.
RigidTransform without_penetration(const TriangleMesh& upper_L, const TriangleMesh& lower_L,
                                   RigidTransform X, const ArchAxes& axes) {
  constexpr int kSteps = 20;
  const Bvh upper(upper_L), lower(lower_L);
  for (int n = 0; n < kSteps; ++n) {
    const double deep_mm =
        std::max(penetration_mm(lower_L, upper, X), penetration_mm(upper_L, lower, X.inverse()));
    if (deep_mm <= kMaxOcclusalPenetration_mm) break;
    X.translation() -= (deep_mm - 0.9 * kMaxOcclusalPenetration_mm) * axes.superior_L;
  }
  return X;
}

/// The most occlusal point of the anterior teeth beside the midline.
Vec3 incisal_edge(const std::vector<Vec3>& points, const Vec3& occlusal, const ArchAxes& axes) {
  constexpr double kFront_mm = 8.0, kCentral_mm = 8.0;
  const Vec3 middle = mean_of(points);
  double front_mm = -std::numeric_limits<double>::infinity();
  for (const Vec3& p : points)
    if (std::abs((p - middle).dot(axes.left_L())) < kCentral_mm)
      front_mm = std::max(front_mm, p.dot(axes.anterior_L));
  Vec3 edge = middle;
  double best_mm = -std::numeric_limits<double>::infinity();
  for (const Vec3& p : points) {
    if (std::abs((p - middle).dot(axes.left_L())) >= kCentral_mm) continue;
    if (p.dot(axes.anterior_L) < front_mm - kFront_mm || p.dot(occlusal) <= best_mm) continue;
    best_mm = p.dot(occlusal);
    edge = p;
  }
  return edge;
}

/// Number of connected patches of vertices.
Index count_patches(const TriangleMesh& mesh, const std::vector<char>& is_in) {
  TriangleMesh part{mesh.vertices, {}};
  for (const geometry::Triangle& triangle : mesh.triangles)
    if (is_in[std::size_t(triangle[0])] && is_in[std::size_t(triangle[1])] &&
        is_in[std::size_t(triangle[2])])
      part.triangles.push_back(triangle);
  return part.triangles.empty() ? 0 : geometry::connected_components(part).count;
}

}  // namespace

Occlusion measure_occlusion(const TriangleMesh& upper_L, const TriangleMesh& lower_L,
                            const RigidTransform& X_LB, const ArchAxes& axes) {
  Occlusion found;
  found.X_L_lower = X_LB;
  const Bvh upper(upper_L);
  const geometry::Pseudonormals normals(lower_L);
  found.gaps_mm.assign(lower_L.vertices.size(), std::numeric_limits<double>::quiet_NaN());
  parallel_for(lower_L.vertex_count(), [&](Index v) {
    const Vec3 n = X_LB.linear() * normals.at_vertex(lower_L, v);
    const Vec3 p = X_LB * lower_L.vertices[std::size_t(v)];
    if (const auto faced = gap_over(upper, p, n, kShownGap_mm))
      found.gaps_mm[std::size_t(v)] = faced->gap_mm;
  });
  const Vec3 middle = mean_of(lower_L.vertices);
  std::vector<char> touches(lower_L.vertices.size(), 0);
  for (std::size_t v = 0; v < found.gaps_mm.size(); ++v)
    touches[v] = found.gaps_mm[v] <= kContactGap_mm ? 1 : 0;
  found.contacts.max_penetration_mm = std::max(
      penetration_mm(lower_L, upper, X_LB), penetration_mm(upper_L, Bvh(lower_L), X_LB.inverse()));
  for (const geometry::Triangle& t : lower_L.triangles) {
    if (!touches[std::size_t(t[0])] || !touches[std::size_t(t[1])] || !touches[std::size_t(t[2])])
      continue;
    const Vec3& a = lower_L.vertices[std::size_t(t[0])];
    const double mm2 = 0.5 * (lower_L.vertices[std::size_t(t[1])] - a)
                                 .cross(lower_L.vertices[std::size_t(t[2])] - a)
                                 .norm();
    ((a - middle).dot(axes.left_L()) > 0.0 ? found.contacts.left_mm2 : found.contacts.right_mm2) +=
        mm2;
  }
  found.contacts.patches = count_patches(lower_L, touches);
  std::vector<Vec3> moved = lower_L.vertices;
  for (Vec3& p : moved) p = X_LB * p;
  const Vec3 between = incisal_edge(upper_L.vertices, -axes.superior_L, axes) -
                       incisal_edge(moved, axes.superior_L, axes);
  constexpr double kOtherTooth_mm = 4.0;
  const bool are_opposite = std::abs(between.dot(axes.left_L())) <= kOtherTooth_mm;
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  found.overjet_mm = are_opposite ? between.dot(axes.anterior_L) : kUnknown;
  found.overbite_mm = are_opposite ? -between.dot(axes.superior_L) : kUnknown;
  return found;
}

Result<Occlusion> find_occlusion(const TriangleMesh& upper_L, const TriangleMesh& lower_L,
                                 const ArchAxes& axes, const OcclusionOptions& options,
                                 Progress& progress) {
  LEFORT_TRY_VOID(geometry::check_surface(upper_L));
  LEFORT_TRY_VOID(geometry::check_surface(lower_L));
  if (!(options.shift_mm >= 0.0 && options.shift_mm <= 5.0) ||
      !(options.yaw_deg >= 0.0 && options.yaw_deg <= 10.0))
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("the spacing of the starts is {} mm and {} degrees, must be 0 to 5 and 0 to 10",
                    options.shift_mm, options.yaw_deg));
  const Arch upper(upper_L, -axes.superior_L), lower(lower_L, axes.superior_L);
  const Vec3 center = mean_of(lower_L.vertices);
  std::optional<RigidTransform> best;
  double best_mm2 = -std::numeric_limits<double>::infinity();
  const std::vector<RigidTransform> starts = starts_of(axes, options, center);
  for (std::size_t n = 0; n < starts.size(); ++n) {
    if (progress.stop_requested()) return fail(ErrorCode::kCancelled, "the search was cancelled");
    progress.report(double(n) / double(starts.size()));
    const auto end = minimize(upper, lower, false, starts[n], center, axes.superior_L, kCoarse);
    if (!end || distance_between(*end, RigidTransform::Identity(), center, axes) > kMaxMovement_mm)
      continue;
    const double mm2 = facing_mm2(upper, lower, *end);
    if (mm2 <= best_mm2) continue;
    best_mm2 = mm2;
    best = end;
  }
  if (best) best = minimize(upper, lower, true, *best, center, axes.superior_L, kFine);
  if (!best)
    return fail(
        ErrorCode::kNotConverged,
        fmt::format("no occlusion was found within {:g} mm: move the lower arch closer to it, "
                    "the arches must face each other",
                    kMaxMovement_mm));
  Occlusion found =
      measure_occlusion(upper_L, lower_L, without_penetration(upper_L, lower_L, *best, axes), axes);
  const OcclusalContacts& contacts = found.contacts;
  if (contacts.max_penetration_mm > kMaxOcclusalPenetration_mm ||
      contacts.left_mm2 + contacts.right_mm2 <= 0.0)
    return fail(ErrorCode::kNotConverged,
                fmt::format("the arches cannot touch without penetration: {:.2f} mm deep, must be "
                            "{:g} or less; are the surfaces in the same frame, and outward?",
                            contacts.max_penetration_mm, kMaxOcclusalPenetration_mm));
  return found;
}

}  // namespace lefort::dental
