#include <lefort/contact/bone_points.h>
#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/geometry/edge_incidence.h>
#include <lefort/geometry/pseudonormals.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace lefort::contact {
namespace {

/// Points per element edge. Between two points a straight edge of the bone lies in the tissue by at
/// most a quarter of their distance times the angle between two tissue faces.
constexpr double kPointsPerElement = 10.0;

/// Cells of the search structure along the longest side of the box.
constexpr int kMaxCells = 64;

constexpr int kDirections = 4;  ///< Tangents +-t that are tried, 45 degrees apart.

bool is_sharp(const BonePoint& at, const DistanceQuery& distance_query_B, double h_mm) {
  const Vec3 t1 = at.normal.unitOrthogonal(), t2 = at.normal.cross(t1);
  std::array<Vec3, 2 * kDirections> around;
  for (int n = 0; n < kDirections; ++n) {
    const double angle = std::numbers::pi * n / kDirections;
    const Vec3 r = 0.5 * h_mm * (std::cos(angle) * t1 + std::sin(angle) * t2);
    around[std::size_t(2 * n)] = at.p + r;
    around[std::size_t(2 * n + 1)] = at.p - r;
  }
  std::array<SignedDistanceSample, 2 * kDirections> samples;
  distance_query_B.measure(around, Derivatives::kFirst, samples);
  for (std::size_t n = 0; n < kDirections; ++n)
    if (std::min(samples[2 * n].distance_mm, samples[2 * n + 1].distance_mm) > h_mm / 8.0 &&
        samples[2 * n].zone != field::Zone::kUnknown &&
        samples[2 * n + 1].zone != field::Zone::kUnknown)
      return true;
  return false;
}

Vec3 normal_of(const geometry::TriangleMesh& bone, Index triangle) {
  const geometry::Triangle& t = bone.triangles[std::size_t(triangle)];
  const Vec3 &a = bone.vertices[std::size_t(t[0])], &b = bone.vertices[std::size_t(t[1])],
             &c = bone.vertices[std::size_t(t[2])];
  return (b - a).cross(c - a).normalized();
}

/// Vertices, and points inside edges that are longer than the spacing.
std::vector<BonePoint> samples_of(const geometry::TriangleMesh& bone, double spacing_mm) {
  std::vector<BonePoint> samples = vertices_of(bone);
  const geometry::EdgeIncidence edges(bone);
  for (std::int32_t v = 0; v < std::int32_t(edges.vertex_count()); ++v)
    edges.for_each_edge_at(
        v, [&](std::int32_t low, std::int32_t high, std::span<const geometry::HalfEdge> sides) {
          const Vec3 &a = bone.vertices[std::size_t(low)], &b = bone.vertices[std::size_t(high)];
          Vec3 normal = Vec3::Zero();
          for (const geometry::HalfEdge& side : sides) normal += normal_of(bone, side.triangle());
          if (!(normal.squaredNorm() > 0.0) || !normal.allFinite()) return;
          const int parts = int(std::ceil((b - a).norm() / spacing_mm));
          for (int n = 1; n < parts; ++n)
            samples.push_back({a + (b - a) * (double(n) / parts), normal.normalized()});
        });
  return samples;
}

}  // namespace

std::vector<BonePoint> vertices_of(const geometry::TriangleMesh& bone_B) {
  std::vector<BonePoint> vertices;
  std::vector<Vec3> normals(bone_B.vertices.size(), Vec3::Zero());
  for (Index t = 0; t < Index(bone_B.triangles.size()); ++t)
    if (const Vec3 normal = normal_of(bone_B, t); normal.allFinite())
      for (const std::int32_t v : bone_B.triangles[std::size_t(t)])
        normals[std::size_t(v)] += normal;
  for (std::size_t v = 0; v < normals.size(); ++v)
    if (normals[v].squaredNorm() > 0.0)
      vertices.push_back({bone_B.vertices[v], normals[v].normalized()});
  return vertices;
}

BonePoints::BonePoints(std::vector<BonePoint> points, double spacing_mm) : spacing_mm_(spacing_mm) {
  LEFORT_CHECK(spacing_mm > 0.0);
  if (points.empty()) return;
  for (const BonePoint& at : points) box_B_.extend(at.p);
  cell_mm_ = std::max(box_B_.sizes().maxCoeff() / kMaxCells, spacing_mm);
  cells_ = (box_B_.sizes().array() / cell_mm_).floor().cast<int>() + 1;
  const auto cell_number = [&](const Vec3& p_B) {
    const Eigen::Array3i c = cell_of(p_B);
    return number_of(c.x(), c.y(), c.z());
  };
  std::stable_sort(points.begin(), points.end(), [&](const BonePoint& a, const BonePoint& b) {
    return cell_number(a.p) < cell_number(b.p);
  });
  for (const BonePoint& at : points) {
    points_B_.push_back(at.p);
    normals_B_.push_back(at.normal);
  }
  first_.assign(std::size_t(cells_.prod()) + 1, points_B_.size());
  for (std::size_t n = points_B_.size(), cell = first_.size() - 1; cell-- > 0;) {
    while (n > 0 && cell_number(points_B_[n - 1]) >= cell) --n;
    first_[cell] = n;
  }
}

Eigen::Array3i BonePoints::cell_of(const Vec3& p_B) const {
  const Eigen::Array3d at = ((p_B - box_B_.min()) / cell_mm_).array().floor();
  return at.max(0.0).min((cells_ - 1).cast<double>()).cast<int>();
}

BonePoints sharp_points(const geometry::TriangleMesh& bone_B, const DistanceQuery& distance_query_B,
                        double element_size_mm) {
  LEFORT_CHECK(element_size_mm > 0.0);
  const double spacing_mm = element_size_mm / kPointsPerElement;
  const std::vector<BonePoint> samples = samples_of(bone_B, spacing_mm);
  std::vector<char> sharp(samples.size(), 0);
  parallel_for(Index(samples.size()), [&](Index n) {
    sharp[std::size_t(n)] = is_sharp(samples[std::size_t(n)], distance_query_B, element_size_mm);
  });
  std::vector<BonePoint> points;
  for (std::size_t n = 0; n < samples.size(); ++n)
    if (sharp[n] != 0) points.push_back(samples[n]);
  return {std::move(points), spacing_mm};
}

}  // namespace lefort::contact
