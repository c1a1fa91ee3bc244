#include <lefort/contact/point_in_patch.h>
#include <lefort/geometry/closest_point.h>

#include <algorithm>
#include <cmath>

namespace lefort::contact {
namespace {

/// Corners of the feature on which the closest point lies, by their number in the triangle.
struct FeatureCorners {
  std::array<int, 3> at{0, 1, 2};
  int count = 3;

  explicit FeatureCorners(geometry::Feature feature) {
    const int n = geometry::number_of(feature);
    if (geometry::is_vertex(feature)) {
      at = {n, n, n};
      count = 1;
    } else if (geometry::is_edge(feature)) {
      at = {n, (n + 1) % 3, n};
      count = 2;
    }
  }
};

/// Angle-weighted pseudonormal of an edge or vertex (\cite baerentzen2005); not of unit length.
Vec3 pseudonormal(std::span<const PatchTriangle> triangles, int key_a, int key_b) {
  Vec3 sum = Vec3::Zero();
  for (const PatchTriangle& corners : triangles) {
    const int a = corners.place_of(key_a), b = corners.place_of(key_b);
    if (a < 0 || b < 0) continue;
    const Vec3 normal = corners.normal().normalized();
    if (!normal.allFinite()) continue;
    if (key_a != key_b) {
      sum += normal;
      continue;
    }
    const Vec3& x = corners.x_L[std::size_t(a)];
    const Vec3 u = (corners.x_L[std::size_t((a + 1) % 3)] - x).normalized();
    const Vec3 v = (corners.x_L[std::size_t((a + 2) % 3)] - x).normalized();
    sum += std::acos(std::clamp(u.dot(v), -1.0, 1.0)) * normal;
  }
  return sum;
}

/// \returns the number of triangles with both corners.
int triangles_at(std::span<const PatchTriangle> triangles, int key_a, int key_b) {
  return int(std::count_if(triangles.begin(), triangles.end(), [&](const PatchTriangle& corners) {
    return corners.place_of(key_a) >= 0 && corners.place_of(key_b) >= 0;
  }));
}

/// Whether an edge, or a vertex if both keys are equal, lies on the border of the contact faces.
/// \pre the hat function of the patch's node is positive there, so that all its triangles are in
///   the patch.
bool is_on_border(std::span<const PatchTriangle> triangles, int key_a, int key_b) {
  if (key_a != key_b) return triangles_at(triangles, key_a, key_b) == 1;
  for (const PatchTriangle& corners : triangles) {
    if (corners.place_of(key_a) < 0) continue;
    for (const int other : corners.keys)
      if (other != key_a && triangles_at(triangles, key_a, other) == 1) return true;
  }
  return false;
}

/// Barycentric coordinates of P in its feature.
std::array<double, 3> coordinates(const PatchTriangle& corners, const FeatureCorners& of,
                                  const Vec3& P) {
  const Vec3& a = corners.x_L[std::size_t(of.at[0])];
  if (of.count == 1) return {1.0, 0.0, 0.0};
  const Vec3 e1 = corners.x_L[std::size_t(of.at[1])] - a;
  if (of.count == 2) {
    const double t = std::clamp((P - a).dot(e1) / e1.squaredNorm(), 0.0, 1.0);
    return {1.0 - t, t, 0.0};
  }
  const Vec3 e2 = corners.x_L[2] - a, n = e1.cross(e2);
  const double xi = (P - a).cross(e2).dot(n) / n.squaredNorm();
  const double eta = e1.cross(P - a).dot(n) / n.squaredNorm();
  return {1.0 - xi - eta, xi, eta};
}

/// Hessian of D for a closest point inside a face: with the outward normal n, the surface gradients
/// a^b of N_b, and dn = - sum a^b (n . dx_b),
///   d2D = 2 dn . sum N_b dx_b - D |dn|^2.
void set_face_hessian(const PatchTriangle& corners, const std::array<double, 3>& N, const Vec3& n,
                      PointDepth& depth) {
  const Vec3 area = corners.normal();
  const double twice_area = area.norm();
  std::array<Vec3, 3> a;
  for (std::size_t b = 0; b < 3; ++b)
    a[b] = n.cross(corners.x_L[(b + 2) % 3] - corners.x_L[(b + 1) % 3]) / twice_area;
  for (std::size_t b = 0; b < 3; ++b)
    for (std::size_t c = 0; c < 3; ++c)
      depth.hessian_L.block<3, 3>(3 * Index(b), 3 * Index(c)) =
          -N[c] * n * a[b].transpose() - N[b] * a[c] * n.transpose() -
          depth.depth_mm * a[b].dot(a[c]) * n * n.transpose();
}

/// Hessian of D for a closest point on an edge or vertex, from that of D^2 / 2.
void set_edge_hessian(const PatchTriangle& corners, const FeatureCorners& of,
                      const std::array<double, 3>& N, const Vec3& r, PointDepth& depth) {
  const Mat3 identity = Mat3::Identity();
  Vec3 e = Vec3::Zero();
  double length2 = 1.0;
  if (of.count == 2) {
    e = corners.x_L[std::size_t(of.at[1])] - corners.x_L[std::size_t(of.at[0])];
    length2 = e.squaredNorm();
  }
  const double D = depth.depth_mm;
  for (std::size_t b = 0; b < std::size_t(of.count); ++b)
    for (std::size_t c = 0; c < std::size_t(of.count); ++c) {
      Mat3 H = N[b] * N[c] * identity;
      Mat3 positive = H;
      if (of.count == 2) {
        const Vec3 f_b = N[b] * e - (b == 0 ? -1.0 : 1.0) * r;
        const Vec3 f_c = N[c] * e - (c == 0 ? -1.0 : 1.0) * r;
        H -= f_b * f_c.transpose() / length2;
        positive -= N[b] * N[c] * e * e.transpose() / length2;
      }
      const Mat3 radial = depth.gradient_L[b] * depth.gradient_L[c].transpose();
      depth.hessian_L.block<3, 3>(3 * Index(b), 3 * Index(c)) = (H - radial) / D;
      depth.positive_L.block<3, 3>(3 * Index(b), 3 * Index(c)) = positive - radial;
    }
}

}  // namespace

std::vector<PatchTriangle> triangles_of(const NodePatch& patch, std::span<const Vec3> x_L) {
  std::vector<PatchTriangle> triangles;
  for (std::size_t face = 0; face < patch.faces.size(); ++face) {
    const PatchFace& part = patch.faces[face];
    const FaceDivision& division = face_division(part.shape);
    const auto count = std::size_t(mesh::node_count(part.shape));
    for (std::size_t t = 0; t < division.triangles.size(); ++t) {
      PatchTriangle& triangle = triangles.emplace_back();
      triangle.face = std::uint8_t(face);
      triangle.number = std::uint8_t(t);
      for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t v = division.triangles[t][c];
        triangle.keys[c] = v < count ? int(part.local[v]) : -1 - int(face);
        triangle.x_L[c].setZero();
        for (std::size_t b = 0; b < count; ++b)
          if (division.vertices[v].N[b] != 0.0)
            triangle.x_L[c] += division.vertices[v].N[b] * x_L[part.local[b]];
      }
    }
  }
  return triangles;
}

std::optional<PointDepth> point_depth(const NodePatch& patch,
                                      std::span<const PatchTriangle> triangles, const Vec3& v_L,
                                      double reach_mm, bool wants_hessian) {
  geometry::TrianglePoint closest{.point = v_L,
                                  .squared_distance_mm2 = reach_mm * reach_mm,
                                  .feature = geometry::Feature::kFace};
  const PatchTriangle* at = nullptr;
  for (const PatchTriangle& candidate : triangles) {
    const auto point = geometry::closest_point_on_triangle(v_L, candidate.x_L[0], candidate.x_L[1],
                                                           candidate.x_L[2]);
    if (!(point.squared_distance_mm2 < closest.squared_distance_mm2)) continue;
    closest = point;
    at = &candidate;
  }
  if (at == nullptr) return std::nullopt;
  const PatchTriangle& corners = *at;
  const FeatureCorners of(closest.feature);
  const std::array<double, 3> N = coordinates(corners, of, closest.point);
  const PatchFace& part = patch.faces[corners.face];
  const FaceDivision& division = face_division(part.shape);
  PointDepth depth;
  const auto vertex = [&](int c) -> const DivisionVertex& {
    return division
        .vertices[division.triangles[corners.number][std::size_t(of.at[std::size_t(c)])]];
  };
  for (int c = 0; c < of.count; ++c) depth.weight += N[std::size_t(c)] * vertex(c).hat[part.center];
  const Vec3 r = v_L - closest.point;
  depth.depth_mm = r.norm();
  if (!(depth.weight > 0.0) || !(depth.depth_mm > 0.0)) return std::nullopt;
  const int key_a = corners.keys[std::size_t(of.at[0])];
  const int key_b = corners.keys[std::size_t(of.at[std::size_t(of.count - 1)])];
  if (of.count < 3 && is_on_border(triangles, key_a, key_b)) return std::nullopt;
  const Vec3 outward = of.count == 3 ? corners.normal() : pseudonormal(triangles, key_a, key_b);
  if (!(outward.dot(r) < 0.0)) return std::nullopt;

  depth.face = corners.face;
  depth.corners = std::uint8_t(of.count);
  const Vec3 n = of.count == 3 ? Vec3(outward.normalized()) : Vec3(-r / depth.depth_mm);
  for (int c = 0; c < of.count; ++c) {
    depth.gradient_L[std::size_t(c)] = N[std::size_t(c)] * n;
    depth.N[std::size_t(c)] = vertex(c).N;
  }
  if (!wants_hessian) return depth;
  depth.hessian_L.setZero();
  depth.positive_L.setZero();
  if (of.count == 3)
    set_face_hessian(corners, N, n, depth);
  else
    set_edge_hessian(corners, of, N, r, depth);
  return depth;
}

}  // namespace lefort::contact
