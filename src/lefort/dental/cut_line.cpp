#include <lefort/dental/cut_line.h>
#include <lefort/geometry/edge_incidence.h>
#include <lefort/geometry/mesh_properties.h>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace lefort::dental {
namespace {

/// Bone faces the viewer if the cosine is larger.
constexpr double kFacesViewer = 0.5;
/// Points of one line are not further from each other.
constexpr double kGap_mm = 5.0;
constexpr double kPointSpacing_mm = 0.5;

/// Points on the edges of a surface that belong to one triangle, and their normals on the bone.
std::vector<Vec3> border_points(const geometry::TriangleMesh& faces_L) {
  const geometry::TriangleMesh welded_L = geometry::weld_vertices(faces_L);
  const geometry::EdgeIncidence edges(welded_L);
  std::vector<Vec3> points_L;
  for (std::int32_t v = 0; v < edges.vertex_count(); ++v)
    edges.for_each_edge_at(v, [&](std::int32_t a, std::int32_t b, const auto& sides) {
      if (sides.size() != 1) return;
      const Vec3 from_L = welded_L.vertices[std::size_t(a)];
      const Vec3 to_L = welded_L.vertices[std::size_t(b)];
      const int parts = std::max(1, int(std::ceil((to_L - from_L).norm() / kPointSpacing_mm)));
      for (int n = 0; n < parts; ++n)
        points_L.emplace_back(from_L + (n + 0.5) / parts * (to_L - from_L));
    });
  return points_L;
}

/// The points that are connected with the first one of `rest`, which loses them.
std::vector<Vec3> take_connected(std::vector<Vec3>& rest) {
  std::vector<Vec3> taken{rest.back()};
  rest.pop_back();
  for (std::size_t n = 0; n < taken.size(); ++n) {
    const Vec3 at = taken[n];
    const auto near = std::partition(rest.begin(), rest.end(), [&](const Vec3& p) {
      return (p - at).squaredNorm() > kGap_mm * kGap_mm;
    });
    taken.insert(taken.end(), near, rest.end());
    rest.erase(near, rest.end());
  }
  return taken;
}

/// The direction of largest extent, perpendicular to the direction of view.
Vec3 direction_of(const std::vector<Vec3>& points_L, const Vec3& outward_L) {
  Vec3 mean = Vec3::Zero();
  for (const Vec3& p : points_L) mean += p / double(points_L.size());
  Mat3 spread = Mat3::Zero();
  const Mat3 flat = Mat3::Identity() - outward_L * outward_L.transpose();
  for (const Vec3& p : points_L) spread += (flat * (p - mean)) * (flat * (p - mean)).transpose();
  const Vec3 along = flat * Eigen::SelfAdjointEigenSolver<Mat3>(spread).eigenvectors().col(2);
  Index largest = 0;
  along.cwiseAbs().maxCoeff(&largest);
  return along.normalized() * (along[largest] < 0.0 ? -1.0 : 1.0);
}

/// Sorted along the line; of points within half the spacing one is kept.
CutLine line_of(std::vector<Vec3> points_L, const Vec3& outward_L) {
  CutLine line{{}, direction_of(points_L, outward_L)};
  std::sort(points_L.begin(), points_L.end(), [&](const Vec3& a, const Vec3& b) {
    const double s = line.position_mm(a), t = line.position_mm(b);
    return s != t ? s < t : std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  });
  for (const Vec3& p : points_L) {
    const bool is_near = std::any_of(line.points_L.rbegin(), line.points_L.rend(), [&](auto& q) {
      return (p - q).norm() < 0.5 * kPointSpacing_mm;
    });
    if (!is_near) line.points_L.push_back(p);
  }
  return line;
}

}  // namespace

bool is_visible(const geometry::Bvh& bone, const Vec3& p_L, const Vec3& normal_L,
                const Vec3& outward_L) {
  constexpr double kLift_mm = 0.2;
  return !bone.first_hit(p_L + kLift_mm * normal_L, outward_L);
}

std::vector<CutLine> visible_cut_lines(const geometry::TriangleMesh& cut_faces_L,
                                       const geometry::Bvh& bone, const Vec3& outward_L,
                                       double min_length_mm) {
  constexpr double kOnBone_mm = 1.0;
  std::vector<Vec3> points_L = border_points(cut_faces_L);
  std::erase_if(points_L, [&](const Vec3& p_L) {
    const auto nearest = bone.closest_point(p_L, kOnBone_mm);
    if (!nearest) return true;
    const Vec3 normal_L =
        bone.pseudonormals().at(bone.mesh(), nearest->triangle, nearest->feature).normalized();
    return !(normal_L.dot(outward_L) >= kFacesViewer) ||
           !is_visible(bone, p_L, normal_L, outward_L);
  });
  std::vector<CutLine> lines;
  while (!points_L.empty()) {
    CutLine line = line_of(take_connected(points_L), outward_L);
    if (line.last_mm() - line.first_mm() >= min_length_mm) lines.push_back(std::move(line));
  }
  std::stable_sort(lines.begin(), lines.end(), [](const CutLine& a, const CutLine& b) {
    return a.last_mm() - a.first_mm() > b.last_mm() - b.first_mm();
  });
  return lines;
}

}  // namespace lefort::dental
