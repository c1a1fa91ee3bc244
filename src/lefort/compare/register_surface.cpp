#include <lefort/compare/register_surface.h>
#include <lefort/compare/surface_difference.h>
#include <lefort/core/decompositions.h>
#include <lefort/core/parallel.h>
#include <lefort/geometry/rigid_motion.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lefort::compare {
namespace {

using geometry::Bvh;
using geometry::TriangleMesh;
using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;

// Of the search among initial alignments; heuristic.
constexpr Index kCoarsePoints = 1000;
constexpr int kCoarseIterations = 40;
/// Tukey's constant for 95 % efficiency, and the standard deviation of a normal distribution over
/// its median absolute deviation.
constexpr double kTukey = 4.685, kSigmaOfMedian = 1.4826;
/// Smallest standard deviation: rounding and chord errors of fine surfaces. With less, an exact fit
/// would reject points at random.
constexpr double kMinSigma_mm = 0.02;
constexpr double kConverged_mm = 1e-3;
/// Steps up to this may never end, because counterparts of some points alternate.
constexpr double kAlternating_mm = 1e-2;
constexpr double kMinStability = 1e-4;
constexpr double kMinInlierFraction = 1.0 / 3.0;

struct Sample {
  Vec3 point, normal;
};

std::vector<Sample> samples_of(const TriangleMesh& mesh, Index maximum) {
  const geometry::Pseudonormals normals(mesh);
  const Index stride = (mesh.vertex_count() + maximum - 1) / maximum;
  std::vector<Sample> samples;
  for (Index v = 0; v < mesh.vertex_count(); v += stride) {
    const Vec3 normal = normals.at_vertex(mesh, v);
    if (normal.squaredNorm() > 0.0) samples.push_back({mesh.vertices[std::size_t(v)], normal});
  }
  return samples;
}

/// A moved sample and the tangent plane at its closest point.
struct Pair {
  Vec3 arm;     ///< From the center of all samples.
  Vec3 normal;  ///< Of the plane; zero if there is no counterpart.
  double off_mm = std::numeric_limits<double>::infinity();  ///< Along the normal, signed.

  [[nodiscard]] bool has_counterpart() const { return std::isfinite(off_mm); }
};

std::vector<Pair> pair_up(const std::vector<Sample>& samples, const RigidTransform& X,
                          const Vec3& center, const Bvh& onto) {
  std::vector<Pair> pairs(samples.size());
  parallel_for(Index(samples.size()), [&](Index i) {
    const Vec3 p = X * samples[std::size_t(i)].point;
    const Vec3 n = X.linear() * samples[std::size_t(i)].normal;
    const auto nearest = onto.closest_point(p);
    Pair& pair = pairs[std::size_t(i)];
    pair.arm = p - center;
    pair.normal = Vec3::Zero();
    if (!nearest) return;
    const Vec3 there =
        onto.pseudonormals().at(onto.mesh(), nearest->triangle, nearest->feature).normalized();
    if (!(n.dot(there) > 0.5)) return;  // 60 degrees: another sheet.
    pair.normal = there;
    pair.off_mm = there.dot(p - nearest->point);
  });
  return pairs;
}

/// Median of the distances; infinite if half of the samples have no counterpart.
double median_distance_mm(const std::vector<Pair>& pairs) {
  std::vector<double> distances;
  distances.reserve(pairs.size());
  for (const Pair& pair : pairs) distances.push_back(std::abs(pair.off_mm));
  const auto middle = distances.begin() + std::ptrdiff_t(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return *middle;
}

double tukey_weight(double off_mm, double width_mm) {
  const double u = off_mm / width_mm;
  return std::abs(u) < 1.0 ? (1.0 - u * u) * (1.0 - u * u) : 0.0;
}

/// Normal equations of one Gauss-Newton step for (rotation times radius, translation).
struct Sums {
  Mat6 matrix = Mat6::Zero();
  Vec6 vector = Vec6::Zero();
  double weight = 0.0;
  double squared = 0.0;

  Sums& operator+=(const Sums& other) {
    matrix += other.matrix;
    vector += other.vector;
    weight += other.weight;
    squared += other.squared;
    return *this;
  }
};

Sums sum_up(const std::vector<Pair>& pairs, double width_mm, double radius_mm) {
  return deterministic_sum(Index(pairs.size()), Sums{}, [&](Index i) {
    const Pair& pair = pairs[std::size_t(i)];
    Sums one;
    if (!pair.has_counterpart()) return one;
    one.weight = tukey_weight(pair.off_mm, width_mm);
    Vec6 row;
    row << pair.arm.cross(pair.normal) / radius_mm, pair.normal;
    one.matrix = one.weight * row * row.transpose();
    one.vector = one.weight * pair.off_mm * row;
    one.squared = one.weight * pair.off_mm * pair.off_mm;
    return one;
  });
}

/// The result of the iterations from one initial alignment.
struct IcpResult {
  Registration registration;
  double median_mm = std::numeric_limits<double>::infinity();
  bool has_converged = false;
};

Result<IcpResult> iterate(const std::vector<Sample>& samples, const Bvh& onto,
                          const RigidTransform& start, int max_iterations, Progress& progress) {
  Vec3 middle = Vec3::Zero();
  for (const Sample& s : samples) middle += s.point / double(samples.size());
  double spread_mm2 = 0.0;
  for (const Sample& s : samples)
    spread_mm2 += (s.point - middle).squaredNorm() / double(samples.size());
  const double radius_mm = std::sqrt(spread_mm2);

  IcpResult now{.registration = {.X_onto_from = start}};
  for (int k = 0; k < max_iterations && !now.has_converged; ++k) {
    if (progress.stop_requested())
      return fail(ErrorCode::kCancelled, "the registration was cancelled");
    RigidTransform& X = now.registration.X_onto_from;
    const Vec3 center = X * middle;
    const std::vector<Pair> pairs = pair_up(samples, X, center, onto);
    now.median_mm = median_distance_mm(pairs);
    if (!std::isfinite(now.median_mm)) break;
    const double width_mm =
        std::max(kTukey * kSigmaOfMedian * now.median_mm, kTukey * kMinSigma_mm);
    const Sums sums = sum_up(pairs, width_mm, radius_mm);
    now.registration.rms_mm = std::sqrt(sums.squared / sums.weight);
    now.registration.inlier_fraction = sums.weight / double(pairs.size());
    const SymmetricEigen<6> eigen = symmetric_eigen(Mat6(sums.matrix / sums.weight));
    now.registration.stability = eigen.values[0];
    if (!(now.registration.stability > kMinStability)) break;
    const Vec6 step =
        -eigen.vectors *
        (eigen.vectors.transpose() * (sums.vector / sums.weight)).cwiseQuotient(eigen.values);
    X = geometry::rigid_motion(step.tail<3>(), step.head<3>() / radius_mm, center) * X;
    now.has_converged = step.norm() < (k + 1 < max_iterations ? kConverged_mm : kAlternating_mm);
  }
  return now;
}

Vec3 centroid(const TriangleMesh& mesh) {
  const std::vector<double> areas_mm2 = vertex_areas(mesh);
  Vec3 sum = Vec3::Zero();
  double total_mm2 = 0.0;
  for (std::size_t v = 0; v < areas_mm2.size(); ++v) {
    sum += areas_mm2[v] * mesh.vertices[v];
    total_mm2 += areas_mm2[v];
  }
  return total_mm2 > 0.0 ? Vec3(sum / total_mm2) : sum;
}

/// Principal axes as the columns of a rotation, by ascending variance.
Mat3 principal_axes(const TriangleMesh& mesh, const Vec3& center) {
  const std::vector<double> areas_mm2 = vertex_areas(mesh);
  Mat3 spread = Mat3::Zero();
  for (std::size_t v = 0; v < areas_mm2.size(); ++v) {
    const Vec3 arm = mesh.vertices[v] - center;
    spread += areas_mm2[v] * arm * arm.transpose();
  }
  Mat3 axes = symmetric_eigen(spread).vectors;
  if (axes.determinant() < 0.0) axes.col(0) = -axes.col(0);
  return axes;
}

/// \returns the motion with this rotation that maps `from` to `onto`.
RigidTransform motion_onto(const Mat3& rotation, const Vec3& from, const Vec3& onto) {
  RigidTransform X = RigidTransform::Identity();
  X.linear() = rotation;
  X.translation() = onto - rotation * from;
  return X;
}

}  // namespace

std::vector<RigidTransform> initial_alignments(const TriangleMesh& from, const TriangleMesh& onto) {
  const Vec3 here = centroid(from), there = centroid(onto);
  const Mat3 axes_here = principal_axes(from, here), axes_there = principal_axes(onto, there);
  std::vector<RigidTransform> starts{RigidTransform::Identity(),
                                     motion_onto(Mat3::Identity(), here, there)};
  for (const Vec3& signs : {Vec3(1, 1, 1), Vec3(1, -1, -1), Vec3(-1, 1, -1), Vec3(-1, -1, 1)}) {
    const Mat3 rotation = axes_there * signs.asDiagonal() * axes_here.transpose();
    starts.push_back(motion_onto(rotation, here, there));
  }
  return starts;
}

Result<Registration> register_surface(const TriangleMesh& from, const Bvh& onto,
                                      std::span<const RigidTransform> starts,
                                      const RegisterOptions& options, Progress& progress) {
  constexpr Index kMinPoints = 100;
  if (options.max_points < kMinPoints || options.max_iterations < 1 ||
      !(options.max_median_mm > 0.0))
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("{} points, {} iterations and a median of {} mm, must be {} and 1 or "
                    "more, and above 0",
                    options.max_points, options.max_iterations, options.max_median_mm, kMinPoints));
  if (starts.empty()) return fail(ErrorCode::kInvalidArgument, "there is no initial alignment");
  const std::vector<Sample> all = samples_of(from, options.max_points);
  if (Index(all.size()) < kMinPoints)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{} vertices with a normal, must be {} or more to register a surface",
                            all.size(), kMinPoints));

  IcpResult best{.registration = {.X_onto_from = starts.front()}};
  if (starts.size() > 1) {
    const std::vector<Sample> few = samples_of(from, kCoarsePoints);
    for (const RigidTransform& start : starts) {
      LEFORT_TRY(IcpResult one, iterate(few, onto, start, kCoarseIterations, progress));
      if (one.median_mm < best.median_mm) best = one;
      progress.report(0.5 * double(&start - starts.data() + 1) / double(starts.size()));
    }
  }
  LEFORT_TRY(best,
             iterate(all, onto, best.registration.X_onto_from, options.max_iterations, progress));
  const Registration& found = best.registration;
  const auto not_converged = [](std::string what) {
    return fail(ErrorCode::kNotConverged, std::move(what));
  };
  if (!std::isfinite(best.median_mm))
    return not_converged(
        "half of the surface or more has no counterpart on the other; do both show the same bone?");
  if (found.inlier_fraction < kMinInlierFraction)
    return not_converged(
        fmt::format("{:.0f} % of the surface have a counterpart on the other, must be {:.0f} %; "
                    "do both show the same bone?",
                    100.0 * found.inlier_fraction, 100.0 * kMinInlierFraction));
  if (!(found.stability > kMinStability))
    return not_converged(
        "the surface can slide along the other, so the motion cannot be determined");
  if (best.median_mm > options.max_median_mm)
    return not_converged(fmt::format(
        "half of the surface is {:.1f} mm or more from the other, must be below {:g} mm; do both "
        "show the same bone?",
        best.median_mm, options.max_median_mm));
  if (!best.has_converged)
    return not_converged(
        fmt::format("the registration does not converge in {} iterations", options.max_iterations));
  return found;
}

}  // namespace lefort::compare
