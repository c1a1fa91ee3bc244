#include <lefort/compare/register_surface.h>
#include <lefort/core/decompositions.h>
#include <lefort/core/parallel.h>
#include <lefort/core/units.h>
#include <lefort/dental/check_arch.h>
#include <lefort/dental/coarse_alignment.h>
#include <lefort/dental/insertion_fit.h>
#include <lefort/dental/register_bite.h>
#include <lefort/geometry/bvh.h>
#include <lefort/geometry/mesh_properties.h>
#include <lefort/geometry/transform_mesh.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

namespace lefort::dental {
namespace {

using geometry::Bvh;
using geometry::TriangleMesh;

/// A bite scan has about a third of its vertices on each arch at least.
constexpr CoarseOptions kPartOfArch{.quantile = 0.3}, kFirstLook{.quantile = 0.3, .iterations = 5};
constexpr double kOnArch_mm = 0.5;
constexpr double kMinOnArches = 0.6, kMinOnEach = 0.15;
/// The scans of both sides agree within this.
constexpr double kMaxBiteMedian_mm = 0.3;

/// The rotations that map coordinate axes to coordinate axes.
std::vector<Mat3> cube_rotations() {
  std::vector<Mat3> rotations;
  std::array<int, 3> order{0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Mat3 R = Mat3::Zero();
      for (int axis = 0; axis < 3; ++axis)
        R(order[std::size_t(axis)], axis) = (signs >> axis & 1) != 0 ? -1.0 : 1.0;
      if (R.determinant() > 0.0) rotations.push_back(R);
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return rotations;
}

Mat3 principal_axes(const std::vector<PointWithNormal>& points, const Vec3& center) {
  Mat3 spread = Mat3::Zero();
  for (const PointWithNormal& one : points)
    spread += (one.point - center) * (one.point - center).transpose();
  Mat3 axes = symmetric_eigen(spread).vectors;
  if (axes.determinant() < 0.0) axes.col(0) = -axes.col(0);
  return axes;
}

/// The mean and points far from each other.
std::vector<Vec3> places_of(const TriangleMesh& arch) {
  constexpr std::size_t kPlaces = 12;
  std::vector<Vec3> places{mean_vertex(arch)};
  std::vector<double> away(arch.vertices.size(), std::numeric_limits<double>::infinity());
  Vec3 latest = places[0];
  while (places.size() <= kPlaces) {
    std::size_t furthest = 0;
    for (std::size_t v = 0; v < away.size(); ++v) {
      away[v] = std::min(away[v], (arch.vertices[v] - latest).squaredNorm());
      if (away[v] > away[furthest]) furthest = v;
    }
    latest = arch.vertices[furthest];
    places.push_back(latest);
  }
  return places;
}

std::vector<RigidTransform> starts_on(const TriangleMesh& upper_L, const ArchAxes& axes,
                                      const std::vector<PointWithNormal>& points,
                                      const Vec3& center) {
  constexpr int kYaws = 6;
  Mat3 here;
  here << axes.left_L(), -axes.anterior_L, axes.superior_L;
  const Mat3 there = principal_axes(points, center);
  std::vector<RigidTransform> starts;
  for (const Vec3& place : places_of(upper_L))
    for (const Mat3& turn : cube_rotations())
      for (int n = 0; n < kYaws; ++n) {
        const double yaw = radians_from_degrees(90.0 * (n + 0.5) / kYaws - 45.0);
        RigidTransform X = RigidTransform::Identity();
        X.linear() = Eigen::AngleAxisd(yaw, axes.superior_L) * here * turn * there.transpose();
        X.translation() = place - X.linear() * center;
        starts.push_back(X);
      }
  return starts;
}

/// Starts around an alignment, for the other arch.
std::vector<RigidTransform> shifted(const RigidTransform& X, const ArchAxes& axes) {
  constexpr double kStep_mm = 5.0;
  std::vector<RigidTransform> starts;
  for (int up = -2; up <= 2; ++up)
    for (int ahead = -2; ahead <= 2; ++ahead)
      for (int aside = -1; aside <= 1; ++aside) {
        RigidTransform moved = X;
        moved.translation() +=
            kStep_mm * (up * axes.superior_L + ahead * axes.anterior_L + aside * axes.left_L());
        starts.push_back(moved);
      }
  return starts;
}

/// Both arches and the alignments of one bite scan with them.
struct BiteAlignment {
  RigidTransform X_upper = RigidTransform::Identity(), X_lower = RigidTransform::Identity();
  double fraction = 0.0;
};

/// Distance of a vertex from an arch; infinite without a facing surface within 2 mm.
double distance_from(const Bvh& arch, const Vec3& p, const Vec3& normal) {
  constexpr double kReach_mm = 2.0, kSameSide = 0.3;
  const auto nearest = arch.closest_point(p, kReach_mm);
  if (!nearest) return std::numeric_limits<double>::infinity();
  const Vec3 there =
      arch.pseudonormals().at(arch.mesh(), nearest->triangle, nearest->feature).normalized();
  return there.dot(normal) > kSameSide ? nearest->distance_mm
                                       : std::numeric_limits<double>::infinity();
}

/// Part of the points on the arches; 0 if one of the arches has too few of them.
double fraction_on(const std::vector<PointWithNormal>& points, const Arches& arches,
                   const BiteAlignment& at) {
  Index near_upper = 0, near_lower = 0;
  for (const PointWithNormal& one : points) {
    const double upper_mm =
        distance_from(arches.upper, at.X_upper * one.point, at.X_upper.linear() * one.normal);
    const double lower_mm =
        distance_from(arches.lower, at.X_lower * one.point, at.X_lower.linear() * one.normal);
    if (std::min(upper_mm, lower_mm) >= kOnArch_mm) continue;
    ++(upper_mm < lower_mm ? near_upper : near_lower);
  }
  const auto count = double(points.size());
  if (double(std::min(near_upper, near_lower)) < kMinOnEach * count) return 0.0;
  return double(near_upper + near_lower) / count;
}

/// The points that do not lie on an arch.
std::vector<PointWithNormal> not_on(const Bvh& arch, const RigidTransform& X,
                                    std::vector<PointWithNormal> points) {
  std::erase_if(points, [&](const PointWithNormal& one) {
    return distance_from(arch, X * one.point, X.linear() * one.normal) < kOnArch_mm;
  });
  return points;
}

BiteAlignment aligned(const TriangleMesh& bite, const Arches& arches, const ArchAxes& axes) {
  constexpr std::size_t kKept = 150, kNear = 4, kCandidates = 8, kMinRest = 20;
  const Vec3 center = mean_vertex(bite);
  const auto fewest = points_with_normals(bite, 60), few = points_with_normals(bite, 120),
             many = points_with_normals(bite, 400);
  const auto first = align_coarsely(fewest, arches.upper, center,
                                    starts_on(arches.upper.mesh(), axes, few, center), kFirstLook);
  std::vector<RigidTransform> kept;
  for (std::size_t n = 0; n < std::min(kKept, first.size()); ++n) kept.push_back(first[n].X);
  auto ends = align_coarsely(few, arches.upper, center, kept, kPartOfArch);
  // Teeth of similar size also fit beside each other.
  std::vector<RigidTransform> beside;
  for (std::size_t n = 0; n < std::min(kNear, ends.size()); ++n)
    for (const RigidTransform& X : shifted(ends[n].X, axes)) beside.push_back(X);
  ends = align_coarsely(few, arches.upper, center, beside, kPartOfArch);
  BiteAlignment best;
  for (std::size_t n = 0; n < std::min(kCandidates, ends.size()); ++n) {
    BiteAlignment one{
        align_coarsely(many, arches.upper, center, {ends[n].X}, kPartOfArch).front().X};
    const auto rest = not_on(arches.upper, one.X_upper, few);
    if (rest.size() < kMinRest) continue;
    one.X_lower = align_coarsely(rest, arches.lower, center, shifted(one.X_upper, axes)).front().X;
    one.fraction = fraction_on(many, arches, one);
    if (one.fraction > best.fraction) best = one;
  }
  return best;
}

/// The part of a bite scan on the upper arch, or on the lower one.
TriangleMesh part_on(const TriangleMesh& bite, const Arches& arches, const BiteAlignment& at,
                     bool is_upper) {
  const geometry::Pseudonormals normals(bite);
  std::vector<char> belongs(bite.vertices.size(), 0);
  parallel_for(bite.vertex_count(), [&](Index v) {
    const Vec3& p = bite.vertices[std::size_t(v)];
    const Vec3 n = normals.at_vertex(bite, v);
    const double upper = distance_from(arches.upper, at.X_upper * p, at.X_upper.linear() * n);
    const double lower = distance_from(arches.lower, at.X_lower * p, at.X_lower.linear() * n);
    belongs[std::size_t(v)] = is_upper ? upper < lower : lower < upper;
  });
  return geometry::keep_triangles(bite, [&](Index t) {
    const geometry::Triangle& triangle = bite.triangles[std::size_t(t)];
    return std::all_of(triangle.begin(), triangle.end(),
                       [&](std::int32_t v) { return belongs[std::size_t(v)] != 0; });
  });
}

Result<void> check_bite(const TriangleMesh& bite) {
  constexpr double kShortest_mm = 8.0;
  LEFORT_TRY_VOID(geometry::check_surface(bite));
  const double length_mm = geometry::bounding_box(bite).diagonal().norm();
  if (length_mm >= kShortest_mm && length_mm <= kMaxArch_mm) return {};
  return fail(ErrorCode::kInvalidArgument,
              fmt::format("the bite scan is {:.3g} mm long, must be {:g} to {:g}: is it in mm?",
                          length_mm, kShortest_mm, kMaxArch_mm));
}

constexpr compare::RegisterOptions kBiteRegistration{.max_points = 8000, .max_median_mm = 0.3};

/// A bite scan on the upper arch, and its lower part there.
struct UpperFit {
  BiteFit fit;
  TriangleMesh lower_L;
};

/// Registers the upper part of a bite scan.
Result<UpperFit> fit_to_upper(const TriangleMesh& bite, const Arches& arches,
                              const BiteAlignment& at, Progress& progress) {
  if (!(at.fraction >= kMinOnArches))
    return fail(ErrorCode::kNotConverged,
                fmt::format("only {:.0f} % of the bite scan lies on the arches, must be {:.0f} % "
                            "or more, with both jaws: is it of the same patient, and not mirrored?",
                            100.0 * at.fraction, 100.0 * kMinOnArches));
  const std::array<RigidTransform, 1> start{at.X_upper};
  LEFORT_TRY(const compare::Registration upper,
             compare::register_surface(part_on(bite, arches, at, true), arches.upper, start,
                                       kBiteRegistration, progress));
  return UpperFit{{upper.X_onto_from, upper.rms_mm, 0.0, at.fraction},
                  geometry::transformed(part_on(bite, arches, at, false), upper.X_onto_from)};
}

TriangleMesh joined(const std::vector<UpperFit>& fits) {
  TriangleMesh all;
  for (const UpperFit& one : fits) {
    const auto first = std::int32_t(all.vertices.size());
    all.vertices.insert(all.vertices.end(), one.lower_L.vertices.begin(),
                        one.lower_L.vertices.end());
    for (const auto& [a, b, c] : one.lower_L.triangles)
      all.triangles.push_back({a + first, b + first, c + first});
  }
  return all;
}

/// Distances of vertices from the lower arch; those without a surface within 2 mm count 2 mm.
std::vector<double> distances_on(const Bvh& arch, const TriangleMesh& part,
                                 const RigidTransform& X) {
  constexpr double kMaxOff_mm = 2.0;
  std::vector<double> distances;
  distances.reserve(part.vertices.size());
  for (const Vec3& p : part.vertices) {
    const auto nearest = arch.closest_point(X * p, kMaxOff_mm);
    distances.push_back(nearest ? nearest->distance_mm : kMaxOff_mm);
  }
  return distances;
}

/// Root mean square of those within 1 mm.
double rms_of(const std::vector<double>& distances_mm) {
  double squared = 0.0;
  Index count = 0;
  for (const double d : distances_mm)
    if (d <= kCounterpart_mm) {
      squared += d * d;
      ++count;
    }
  return count > 0 ? std::sqrt(squared / double(count)) : 0.0;
}

}  // namespace

Result<Bite> register_bite(const TriangleMesh& upper_L, const TriangleMesh& lower_L,
                           const ArchAxes& axes, std::span<const TriangleMesh> bites,
                           Progress& progress) {
  LEFORT_TRY_VOID(check_arch(upper_L, "upper", -axes.superior_L));
  LEFORT_TRY_VOID(check_arch(lower_L, "lower", axes.superior_L));
  if (bites.empty()) return fail(ErrorCode::kInvalidArgument, "no bite scan is given");
  for (const TriangleMesh& bite : bites) LEFORT_TRY_VOID(check_bite(bite));
  progress.begin_stage("register the bite scan");
  const Arches arches{Bvh(upper_L), Bvh(lower_L)};
  std::vector<UpperFit> fits;
  RigidTransform start = RigidTransform::Identity();
  for (const TriangleMesh& bite : bites) {
    const BiteAlignment at = aligned(bite, arches, axes);
    if (progress.stop_requested())
      return fail(ErrorCode::kCancelled, "the registration was cancelled");
    LEFORT_TRY(UpperFit fit, fit_to_upper(bite, arches, at, progress));
    if (fits.empty()) start = at.X_lower * fit.fit.X_L_bite.inverse();
    fits.push_back(std::move(fit));
  }
  const std::array<RigidTransform, 1> starts{start};
  LEFORT_TRY(
      const compare::Registration lower,
      compare::register_surface(joined(fits), arches.lower, starts, kBiteRegistration, progress));
  Bite found{lower.X_onto_from.inverse(), {}};
  for (UpperFit& one : fits) {
    const std::vector<double> off_mm = distances_on(arches.lower, one.lower_L, lower.X_onto_from);
    one.fit.lower_rms_mm = rms_of(off_mm);
    if (const double median_mm = percentile(off_mm, 0.5); !(median_mm <= kMaxBiteMedian_mm))
      return fail(
          ErrorCode::kNotConverged,
          fmt::format("the bite scans do not fit together: one is {:.2f} mm (median) off the "
                      "lower arch, must be {:g} or less",
                      median_mm, kMaxBiteMedian_mm));
    found.fits.push_back(one.fit);
  }
  return found;
}

}  // namespace lefort::dental
