#include <lefort/core/parallel.h>
#include <lefort/dental/check_arch.h>
#include <lefort/dental/faced_gap.h>
#include <lefort/dental/measure_occlusion.h>
#include <lefort/geometry/mesh_properties.h>
#include <lefort/geometry/transform_mesh.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace lefort::dental {
namespace {

using geometry::Bvh;
using geometry::TriangleMesh;

constexpr double kShownGap_mm = 3.0;

/// Deepest penetration of the vertices of `points`, moved by `X`, into `surface`.
///
/// A distance from a surface changes by no more than the length of the way: a vertex is not deeper
/// than the length of an edge less the distance of its other end, if that is outside. Without this,
/// one triangle that a scanner has turned over, or the border of an open surface, would count.
double penetration_mm(const Bvh& points, const Bvh& surface, const RigidTransform& X,
                      double reach_mm) {
  const TriangleMesh& mesh = points.mesh();
  std::vector<double> depths(mesh.vertices.size(), 0.0), outside(mesh.vertices.size(), 0.0);
  parallel_for(mesh.vertex_count(), [&](Index v) {
    const Vec3 p = X * mesh.vertices[std::size_t(v)];
    const auto there = offset_from(surface, p, reach_mm);
    if (!there || there->is_beyond) return;
    if (there->along_mm > 0.0) outside[std::size_t(v)] = there->distance_mm;
    const Vec3 n = X.linear() * points.pseudonormals().at_vertex(mesh, v);
    if (there->normal.dot(n) < kFacingCosine)
      depths[std::size_t(v)] = std::max(-there->along_mm, 0.0);
  });
  for (const geometry::Triangle& triangle : mesh.triangles)
    for (std::size_t n = 0; n < 3; ++n) {
      const auto v = std::size_t(triangle[n]);
      for (const std::size_t other : {(n + 1) % 3, (n + 2) % 3}) {
        const auto w = std::size_t(triangle[other]);
        if (depths[v] <= 0.0 || outside[w] <= 0.0) continue;
        const double length_mm = (mesh.vertices[v] - mesh.vertices[w]).norm();
        depths[v] = std::min(depths[v], std::max(0.0, length_mm - outside[w]));
      }
    }
  return depths.empty() ? 0.0 : *std::max_element(depths.begin(), depths.end());
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

/// Gap of each vertex of the lower arch; NaN further than kShownGap_mm.
std::vector<double> gaps_of(const Arches& arches, const RigidTransform& X_LB) {
  const TriangleMesh& mesh = arches.lower.mesh();
  std::vector<double> gaps_mm(mesh.vertices.size(), std::numeric_limits<double>::quiet_NaN());
  parallel_for(mesh.vertex_count(), [&](Index v) {
    const Vec3 n = X_LB.linear() * arches.lower.pseudonormals().at_vertex(mesh, v);
    const Vec3 p = X_LB * mesh.vertices[std::size_t(v)];
    if (const auto faced = gap_over(arches.upper, p, n, kShownGap_mm))
      gaps_mm[std::size_t(v)] = faced->gap_mm;
  });
  return gaps_mm;
}

OcclusalContacts contacts_of(const TriangleMesh& lower_L, const std::vector<double>& gaps_mm,
                             const ArchAxes& axes) {
  OcclusalContacts contacts;
  const Vec3 middle = mean_vertex(lower_L);
  std::vector<char> touches(lower_L.vertices.size(), 0);
  for (std::size_t v = 0; v < gaps_mm.size(); ++v)
    touches[v] = gaps_mm[v] <= kContactGap_mm ? 1 : 0;
  for (const geometry::Triangle& t : lower_L.triangles) {
    if (!touches[std::size_t(t[0])] || !touches[std::size_t(t[1])] || !touches[std::size_t(t[2])])
      continue;
    const Vec3& a = lower_L.vertices[std::size_t(t[0])];
    const double mm2 = 0.5 * (lower_L.vertices[std::size_t(t[1])] - a)
                                 .cross(lower_L.vertices[std::size_t(t[2])] - a)
                                 .norm();
    ((a - middle).dot(axes.left_L()) > 0.0 ? contacts.left_mm2 : contacts.right_mm2) += mm2;
  }
  contacts.patches = count_patches(lower_L, touches);
  return contacts;
}

}  // namespace

namespace {

/// Position along the left direction.
struct Window {
  double middle_mm = 0.0, half_width_mm = 0.0;
};

/// The vertex furthest along `occlusal` of the most anterior 8 mm within a window.
std::optional<Vec3> edge_within(const TriangleMesh& arch, const Vec3& occlusal,
                                const ArchAxes& axes, const Window& window) {
  constexpr double kFront_mm = 8.0;
  const auto is_in = [&](const Vec3& p) {
    return std::abs(p.dot(axes.left_L()) - window.middle_mm) < window.half_width_mm;
  };
  double front_mm = -std::numeric_limits<double>::infinity();
  for (const Vec3& p : arch.vertices)
    if (is_in(p)) front_mm = std::max(front_mm, p.dot(axes.anterior_L));
  std::optional<Vec3> edge;
  double best_mm = -std::numeric_limits<double>::infinity();
  for (const Vec3& p : arch.vertices) {
    if (!is_in(p) || p.dot(axes.anterior_L) < front_mm - kFront_mm) continue;
    if (p.dot(occlusal) <= best_mm) continue;
    best_mm = p.dot(occlusal);
    edge = p;
  }
  return edge;
}

}  // namespace

std::optional<IncisalEdges> incisal_edges(const TriangleMesh& upper_L, const TriangleMesh& lower_L,
                                          const ArchAxes& axes) {
  constexpr double kCentral_mm = 8.0, kOpposite_mm = 4.0;
  const auto upper = edge_within(upper_L, -axes.superior_L, axes,
                                 {mean_vertex(upper_L).dot(axes.left_L()), kCentral_mm});
  if (!upper) return std::nullopt;
  const auto lower =
      edge_within(lower_L, axes.superior_L, axes, {upper->dot(axes.left_L()), kOpposite_mm});
  if (!lower) return std::nullopt;
  return IncisalEdges{*upper, *lower};
}

double max_penetration_mm(const Arches& arches, const RigidTransform& X_LB, double reach_mm) {
  return std::max(penetration_mm(arches.lower, arches.upper, X_LB, kArchReach_mm),
                  penetration_mm(arches.upper, arches.lower, X_LB.inverse(), reach_mm));
}

Occlusion measure_occlusion(const Arches& arches, const RigidTransform& X_LB, const ArchAxes& axes,
                            double reach_mm) {
  Occlusion found;
  found.X_L_lower = X_LB;
  found.gaps_mm = gaps_of(arches, X_LB);
  found.contacts = contacts_of(arches.lower.mesh(), found.gaps_mm, axes);
  found.contacts.max_penetration_mm = max_penetration_mm(arches, X_LB, reach_mm);
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  const auto edges =
      incisal_edges(arches.upper.mesh(), geometry::transformed(arches.lower.mesh(), X_LB), axes);
  const Vec3 between = edges ? Vec3(edges->upper_L - edges->lower_L) : Vec3(Vec3::Zero());
  found.overjet_mm = edges ? between.dot(axes.anterior_L) : kUnknown;
  found.overbite_mm = edges ? -between.dot(axes.superior_L) : kUnknown;
  return found;
}

}  // namespace lefort::dental
