#include <lefort/core/parallel.h>
#include <lefort/dental/beyond_border.h>
#include <lefort/dental/coarse_alignment.h>
#include <lefort/geometry/pseudonormals.h>
#include <lefort/geometry/rigid_motion.h>

#include <algorithm>
#include <cmath>

namespace lefort::dental {
namespace {

using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;
/// Rotations count as the displacement at this distance from the center.
constexpr double kArm_mm = 20.0;

/// Distances along the normals and their derivatives; infinite without a counterpart.
struct Distances {
  std::vector<double> off;
  std::vector<double> size;  ///< Absolute; to a border, of the whole way.
  std::vector<Vec6> rows;
};

Distances distances_at(const std::vector<PointWithNormal>& points, const geometry::Bvh& surface,
                       const Vec3& center, const RigidTransform& X) {
  constexpr double kFacing = 0.3;
  Distances at{std::vector<double>(points.size(), std::numeric_limits<double>::infinity()),
               std::vector<double>(points.size(), std::numeric_limits<double>::infinity()),
               std::vector<Vec6>(points.size(), Vec6::Zero())};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 p = X * points[i].point;
    const auto nearest = surface.closest_point(p);
    if (!nearest) continue;
    const Vec3 there = surface.pseudonormals()
                           .at(surface.mesh(), nearest->triangle, nearest->feature)
                           .normalized();
    if (!(there.dot(X.linear() * points[i].normal) > kFacing)) continue;
    const Vec3 offset = p - nearest->point;
    if (is_beyond_border(offset, there) && offset.norm() < kCounterpart_mm) continue;
    at.off[i] = there.dot(offset);
    at.size[i] = is_beyond_border(offset, there) ? offset.norm() : std::abs(at.off[i]);
    at.rows[i] << (p - X * center).cross(there) / kArm_mm, there;
  }
  return at;
}

double quantile_of(std::vector<double> sizes, double quantile) {
  const auto middle = sizes.begin() + std::ptrdiff_t(quantile * double(sizes.size()));
  std::nth_element(sizes.begin(), middle, sizes.end());
  return *middle;
}

Alignment iterate_coarsely(const std::vector<PointWithNormal>& points, const geometry::Bvh& surface,
                           const Vec3& center, const RigidTransform& X,
                           const CoarseOptions& options) {
  constexpr double kTukeyWidth = 4.685 * 1.4826, kMinWidth_mm = 0.3, kMaxWidth_mm = 10.0;
  Alignment now{X};
  for (int n = 0; n < options.iterations; ++n) {
    const Distances at = distances_at(points, surface, center, now.X);
    now.off_mm = quantile_of(at.size, options.quantile);
    const double width_mm =
        std::isfinite(now.off_mm) ? std::max(kTukeyWidth * now.off_mm, kMinWidth_mm) : kMaxWidth_mm;
    Mat6 A = Mat6::Identity() * 1e-3;
    Vec6 b = Vec6::Zero();
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!(at.size[i] < width_mm)) continue;
      const double u = at.size[i] / width_mm, w = (1.0 - u * u) * (1.0 - u * u);
      A += w * at.rows[i] * at.rows[i].transpose();
      b -= w * at.off[i] * at.rows[i];
    }
    const Vec6 step = A.ldlt().solve(b);
    now.X =
        geometry::rigid_motion(step.tail<3>(), step.head<3>() / kArm_mm, now.X * center) * now.X;
  }
  now.off_mm = quantile_of(distances_at(points, surface, center, now.X).size, options.quantile);
  return now;
}

}  // namespace

std::vector<PointWithNormal> points_with_normals(const geometry::TriangleMesh& mesh,
                                                 Index maximum) {
  const geometry::Pseudonormals normals(mesh);
  const Index stride = std::max<Index>((mesh.vertex_count() + maximum - 1) / maximum, 1);
  std::vector<PointWithNormal> points;
  for (Index v = 0; v < mesh.vertex_count(); v += stride)
    points.push_back({mesh.vertices[std::size_t(v)], normals.at_vertex(mesh, v)});
  return points;
}

std::vector<Alignment> align_coarsely(const std::vector<PointWithNormal>& points,
                                      const geometry::Bvh& surface, const Vec3& center,
                                      const std::vector<RigidTransform>& starts,
                                      const CoarseOptions& options) {
  std::vector<Alignment> ends(starts.size());
  parallel_for(
      Index(starts.size()),
      [&](Index n) {
        ends[std::size_t(n)] =
            iterate_coarsely(points, surface, center, starts[std::size_t(n)], options);
      },
      1);
  std::stable_sort(ends.begin(), ends.end(),
                   [](const Alignment& a, const Alignment& b) { return a.off_mm < b.off_mm; });
  return ends;
}

}  // namespace lefort::dental
