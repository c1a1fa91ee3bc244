#include <lefort/contact/point_in_patch.h>
#include <lefort/geometry/closest_point.h>
#include <lefort/mesh/element_faces.h>

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

/// eta and its derivatives by the barycentric coordinates.
struct FromBorder {
  double eta = 0.0;
  std::array<double, 3> by_N{};

  /// \param N  barycentric coordinates in the triangle.
  FromBorder(const PatchTriangle& corners, const std::array<double, 3>& N) {
    const auto of_corner = [&](std::size_t c) { return corners.border_corners[c] ? 0.0 : 1.0; };
    const auto of_edge = [&](std::size_t e) { return corners.border_edges[e] ? 0.0 : 1.0; };
    const auto largest = std::size_t(std::max_element(N.begin(), N.end()) - N.begin());
    if (N[largest] > 0.5) {
      const std::size_t b = (largest + 1) % 3, c = (largest + 2) % 3;
      by_N[largest] = of_corner(largest);
      by_N[b] = 2.0 * of_edge(largest) - of_corner(largest);
      by_N[c] = 2.0 * of_edge(c) - of_corner(largest);
    } else {
      for (std::size_t c = 0; c < 3; ++c) {
        // The middle opposite to corner c has the coordinate 1 - 2 N_c = N_0 + N_1 + N_2 - 2 N_c.
        const double value = of_edge((c + 1) % 3);
        for (std::size_t b = 0; b < 3; ++b) by_N[b] += b == c ? -value : value;
      }
    }
    for (std::size_t c = 0; c < 3; ++c) eta += by_N[c] * N[c];
  }
};

/// dN_b / dx_c as a row.
using ShapeGradients = std::array<std::array<Vec3, 3>, 3>;

/// Sets fade and fade_gradient_L.
/// \param of        feature of P.
/// \param N         barycentric coordinates in the feature.
/// \param dN        their derivatives by the corners of the feature.
void set_fade(const PatchTriangle& corners, const FeatureCorners& of,
              const std::array<double, 3>& N, const ShapeGradients& dN, PointDepth& depth) {
  std::array<double, 3> in_triangle{};
  for (int c = 0; c < of.count; ++c)
    in_triangle[std::size_t(of.at[std::size_t(c)])] = N[std::size_t(c)];
  const FromBorder border(corners, in_triangle);
  const double t = std::clamp(border.eta / kFadeWidth, 0.0, 1.0);
  depth.fade = t * t * (3.0 - 2.0 * t);
  if (t == 0.0 || t == 1.0) return;
  const double slope = 6.0 * t * (1.0 - t) / kFadeWidth;
  for (std::size_t c = 0; c < std::size_t(of.count); ++c)
    for (std::size_t b = 0; b < std::size_t(of.count); ++b)
      depth.fade_gradient_L[c] += slope * border.by_N[std::size_t(of.at[b])] * dN[b][c];
}

/// Surface gradients a^b of the shape functions of a triangle.
/// \param n  outward normal.
std::array<Vec3, 3> surface_gradients(const PatchTriangle& corners, const Vec3& n) {
  const double twice_area = corners.normal().norm();
  std::array<Vec3, 3> a;
  for (std::size_t b = 0; b < 3; ++b)
    a[b] = n.cross(corners.x_L[(b + 2) % 3] - corners.x_L[(b + 1) % 3]) / twice_area;
  return a;
}

/// dN_b / dx_c of a closest point: inside a face - D (a^b . a^c) n - N_c a^b, on an edge e - (N_c e
/// -+ r) / |e|^2 for its end and the negative for its start; 0 at a vertex.
/// \param r  v - P.
ShapeGradients shape_gradients(const PatchTriangle& corners, const FeatureCorners& of,
                               const std::array<double, 3>& N, const Vec3& r) {
  ShapeGradients dN;
  for (auto& row : dN) row.fill(Vec3::Zero());
  if (of.count == 3) {
    const Vec3 n = corners.normal().normalized();
    const std::array<Vec3, 3> a = surface_gradients(corners, n);
    for (std::size_t b = 0; b < 3; ++b)
      for (std::size_t c = 0; c < 3; ++c) dN[b][c] = -r.norm() * a[b].dot(a[c]) * n - N[c] * a[b];
  } else if (of.count == 2) {
    const Vec3 e = corners.x_L[std::size_t(of.at[1])] - corners.x_L[std::size_t(of.at[0])];
    for (std::size_t c = 0; c < 2; ++c) {
      dN[1][c] = -(N[c] * e - (c == 0 ? -1.0 : 1.0) * r) / e.squaredNorm();
      dN[0][c] = -dN[1][c];
    }
  }
  return dN;
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
  const std::array<Vec3, 3> a = surface_gradients(corners, n);
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

/// Sets border_corners and border_edges.
/// \param vertices  of the triangle, by their number in the division.
void mark_border(const NodePatch& patch, const PatchFace& part,
                 const std::array<std::uint8_t, 3>& vertices, PatchTriangle& triangle) {
  const int count = mesh::node_count(part.shape), corners = mesh::corner_count(part.shape);
  const auto lies_on = [&](int v, int side) {
    return v == side || v == (side + 1) % corners || v == corners + side;
  };
  for (std::size_t c = 0; c < 3; ++c) {
    const int v = vertices[c], next = vertices[(c + 1) % 3];
    triangle.border_corners[c] = v < count && patch.on_border[part.local[std::size_t(v)]];
    for (int side = 0; side < corners; ++side)
      if ((part.border_sides >> unsigned(side) & 1U) != 0 && v < count && next < count &&
          lies_on(v, side) && lies_on(next, side))
        triangle.border_edges[c] = true;
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
      mark_border(patch, part, division.triangles[t], triangle);
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
                                      std::span<const PatchTriangle> triangles, const BonePoint& v,
                                      double max_depth_mm, bool wants_hessian) {
  const Vec3& v_L = v.p;
  geometry::TrianglePoint closest{.point = v_L,
                                  .squared_distance_mm2 = max_depth_mm * max_depth_mm,
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
  const Vec3 outward = of.count == 3 ? corners.normal() : pseudonormal(triangles, key_a, key_b);
  if (!(outward.dot(r) < 0.0) || !(outward.dot(v.normal) < 0.0)) return std::nullopt;
  set_fade(corners, of, N, shape_gradients(corners, of, N, r), depth);
  if (!(depth.fade > 0.0)) return std::nullopt;

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
