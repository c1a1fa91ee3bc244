#include <lefort/core/check.h>
#include <lefort/core/units.h>
#include <lefort/mesh/element_faces.h>
#include <lefort/mesh/element_quality.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace lefort::mesh {
namespace {

/// The angle inside the tetrahedron along edge pq, between the faces towards r and s.
double dihedral_deg(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s) {
  const Vec3 along = (q - p).normalized();
  const Vec3 to_r = (r - p) - along.dot(r - p) * along;
  const Vec3 to_s = (s - p) - along.dot(s - p) * along;
  return degrees_from_radians(std::atan2(to_r.cross(to_s).norm(), to_r.dot(to_s)));
}

/// Six times the volume, divided by the product of the three edge lengths at a corner; minimum over
/// the corners, which occurs at the largest product. 1 / sqrt(2) if regular.
double min_corner_jacobian(double volume_mm3, const std::array<Vec3, 4>& p) {
  double max_product = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    double product = 1.0;
    for (std::size_t j = 0; j < 4; ++j)
      if (j != i) product *= (p[j] - p[i]).norm();
    max_product = std::max(max_product, product);
  }
  return max_product > 0.0 ? 6.0 * volume_mm3 / max_product : 0.0;
}

/// 3 r / R, with r = 3 V / A and R = |a^2 (b x c) + b^2 (c x a) + c^2 (a x b)| / (12 V), where
/// a, b, c are the edges from one corner.
double radius_ratio_of(double volume_mm3, const Vec3& a, const Vec3& b, const Vec3& c) {
  const double area_mm2 = 0.5 * (a.cross(b).norm() + b.cross(c).norm() + c.cross(a).norm() +
                                 (b - a).cross(c - a).norm());
  const Vec3 center_12_volumes =
      a.squaredNorm() * b.cross(c) + b.squaredNorm() * c.cross(a) + c.squaredNorm() * a.cross(b);
  const double scale = area_mm2 * center_12_volumes.norm();
  return scale > 0.0 ? 108.0 * volume_mm3 * std::abs(volume_mm3) / scale : 0.0;
}

/// The three neighbors of each corner, in the order in which they span a positive volume.
using Neighbors = std::array<std::int8_t, 3>;
constexpr std::array<Neighbors, 4> kTetCorners{{{1, 2, 3}, {2, 0, 3}, {0, 1, 3}, {0, 2, 1}}};
constexpr std::array<Neighbors, 4> kPyramidCorners{{{1, 3, 4}, {2, 0, 4}, {3, 1, 4}, {0, 2, 4}}};
constexpr std::array<Neighbors, 6> kWedgeCorners{
    {{2, 1, 3}, {0, 2, 4}, {1, 0, 5}, {4, 5, 0}, {5, 3, 1}, {3, 4, 2}}};
constexpr std::array<Neighbors, 8> kHexCorners{
    {{1, 3, 4}, {2, 0, 5}, {3, 1, 6}, {0, 2, 7}, {7, 5, 0}, {4, 6, 1}, {5, 7, 2}, {6, 4, 3}}};

/// The corners that are used, and the inverse of the value of the ideal element there.
struct CornerTable {
  std::span<const Neighbors> corners;
  double scale;
};

CornerTable corner_table(ElementShape shape) {
  switch (corner_count(shape)) {
    case 4:
      return {kTetCorners, std::numbers::sqrt2};
    case 5:
      return {kPyramidCorners, std::numbers::sqrt2};
    case 6:
      return {kWedgeCorners, 2.0 / std::numbers::sqrt3};
    default:
      return {kHexCorners, 1.0};
  }
}

/// The tangent, at corner `from`, of its edge to corner `to`. A straight edge is its own tangent.
Vec3 edge_tangent(ElementShape shape, std::span<const Vec3> nodes, int from, int to) {
  const Vec3 chord = nodes[std::size_t(to)] - nodes[std::size_t(from)];
  const int corners = corner_count(shape);
  if (node_count(shape) == corners) return chord;
  const auto edges = edges_of(shape);
  const auto edge = std::find_if(edges.begin(), edges.end(), [&](const auto& ends) {
    return (ends[0] == from && ends[1] == to) || (ends[0] == to && ends[1] == from);
  });
  const auto middle = std::size_t(corners + int(edge - edges.begin()));
  return 4.0 * (nodes[middle] - nodes[std::size_t(from)]) - chord;
}

}  // namespace

double scaled_jacobian(ElementShape shape, std::span<const Vec3> nodes) {
  LEFORT_CHECK(nodes.size() == std::size_t(node_count(shape)));
  const CornerTable table = corner_table(shape);
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t corner = 0; corner < table.corners.size(); ++corner) {
    std::array<Vec3, 3> edge;
    double product = 1.0;
    for (std::size_t n = 0; n < 3; ++n) {
      edge[n] = edge_tangent(shape, nodes, int(corner), table.corners[corner][n]);
      product *= edge[n].norm();
    }
    const double volume = edge[0].cross(edge[1]).dot(edge[2]);
    smallest = std::min(smallest, product > 0.0 ? table.scale * volume / product : 0.0);
  }
  return smallest;
}

std::vector<PoorElement> poor_elements(const VolumeMesh& mesh, double limit) {
  std::vector<PoorElement> poor;
  std::vector<Vec3> nodes;
  Index number = 0;
  for (const ElementBlock& block : mesh.blocks)
    for (Index e = 0; e < block.element_count(); ++e, ++number) {
      nodes.clear();
      Vec3 center_L = Vec3::Zero();
      for (int a = 0; a < node_count(block.shape); ++a) {
        nodes.push_back(mesh.nodes_L[std::size_t(block.element(e)[a])]);
        center_L += nodes.back() / node_count(block.shape);
      }
      const double quality = scaled_jacobian(block.shape, nodes);
      if (!(quality > limit)) poor.push_back({number, block.shape, center_L, quality});
    }
  return poor;
}

TetQuality tet_quality(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  TetQuality quality{};
  quality.volume_mm3 = (b - a).cross(c - a).dot(d - a) / 6.0;
  const std::array<double, 6> angles_deg{dihedral_deg(a, b, c, d), dihedral_deg(a, c, b, d),
                                         dihedral_deg(a, d, b, c), dihedral_deg(b, c, a, d),
                                         dihedral_deg(b, d, a, c), dihedral_deg(c, d, a, b)};
  quality.min_dihedral_deg = *std::min_element(angles_deg.begin(), angles_deg.end());
  quality.max_dihedral_deg = *std::max_element(angles_deg.begin(), angles_deg.end());
  quality.scaled_jacobian =
      std::numbers::sqrt2 * min_corner_jacobian(quality.volume_mm3, {a, b, c, d});
  quality.radius_ratio = radius_ratio_of(quality.volume_mm3, b - a, c - a, d - a);
  return quality;
}

std::array<double, 2> dihedral_range_deg(ElementShape shape, std::span<const Vec3> nodes) {
  LEFORT_CHECK(node_count(shape) == corner_count(shape));
  LEFORT_CHECK(nodes.size() == std::size_t(node_count(shape)));
  std::array<double, 2> range_deg{180.0, 0.0};
  const std::span<const Neighbors> corners = corner_table(shape).corners;
  for (std::size_t corner = 0; corner < corners.size(); ++corner)
    for (std::size_t n = 0; n < 3; ++n) {
      const auto end = [&](std::size_t k) { return nodes[std::size_t(corners[corner][k % 3])]; };
      const double angle_deg = dihedral_deg(nodes[corner], end(n), end(n + 1), end(n + 2));
      range_deg = {std::min(range_deg[0], angle_deg), std::max(range_deg[1], angle_deg)};
    }
  return range_deg;
}

double volume_of(ElementShape shape, std::span<const Vec3> nodes) {
  LEFORT_CHECK(nodes.size() == std::size_t(node_count(shape)));
  // Six times the volume between each face and the first node. For a bilinear face it is the mean
  // over the two ways to split the face into triangles.
  double sixfold = 0.0;
  for (const LocalFace& face : faces_of(shape)) {
    const auto at = [&](std::size_t k) {
      return Vec3(nodes[std::size_t(face.nodes[k])] - nodes[0]);
    };
    const auto under = [&](std::size_t a, std::size_t b, std::size_t c) {
      return at(a).cross(at(b)).dot(at(c));
    };
    sixfold += corner_count(face.shape) == 3
                   ? under(0, 1, 2)
                   : 0.5 * (under(0, 1, 2) + under(0, 2, 3) + under(0, 1, 3) + under(1, 2, 3));
  }
  return sixfold / 6.0;
}

namespace {

struct ElementQuality {
  double volume_mm3, min_dihedral_deg, max_dihedral_deg, scaled_jacobian;
};

QualitySummary empty_summary() {
  QualitySummary summary;
  summary.min_volume_mm3 = summary.min_dihedral_deg = summary.min_scaled_jacobian =
      std::numeric_limits<double>::infinity();
  return summary;
}

/// The mean is a sum until finish().
void add(QualitySummary& all, const ElementQuality& one) {
  const auto bin = [](double fraction, std::size_t bins) {
    return std::size_t(std::clamp(fraction * double(bins), 0.0, double(bins) - 1.0));
  };
  all.volume_mm3 += one.volume_mm3;
  all.min_volume_mm3 = std::min(all.min_volume_mm3, one.volume_mm3);
  all.min_dihedral_deg = std::min(all.min_dihedral_deg, one.min_dihedral_deg);
  all.max_dihedral_deg = std::max(all.max_dihedral_deg, one.max_dihedral_deg);
  all.min_scaled_jacobian = std::min(all.min_scaled_jacobian, one.scaled_jacobian);
  all.mean_scaled_jacobian += one.scaled_jacobian;
  ++all.jacobian_histogram[bin(one.scaled_jacobian, all.jacobian_histogram.size())];
  ++all.dihedral_histogram[bin(one.min_dihedral_deg / 90.0, all.dihedral_histogram.size())];
  ++all.elements;
}

void finish(QualitySummary& all) { all.mean_scaled_jacobian /= double(all.elements); }

}  // namespace

MeshQuality measure_quality(const VolumeMesh& mesh) {
  if (mesh.element_count() == 0) return {};
  MeshQuality all;
  static_cast<QualitySummary&>(all) = empty_summary();
  double radius_ratios = 0.0;
  Index tets = 0;
  std::vector<Vec3> nodes;
  for (const ElementBlock& block : mesh.blocks) {
    if (block.element_count() == 0) continue;
    auto of_shape = std::find_if(all.by_shape.begin(), all.by_shape.end(),
                                 [&](const auto& entry) { return entry.first == block.shape; });
    if (of_shape == all.by_shape.end())
      of_shape = all.by_shape.insert(of_shape, {block.shape, empty_summary()});
    for (Index e = 0; e < block.element_count(); ++e) {
      nodes.clear();
      for (int n = 0; n < node_count(block.shape); ++n)
        nodes.push_back(mesh.nodes_L[std::size_t(block.element(e)[n])]);
      ElementQuality one{};
      if (corner_count(block.shape) == 4) {
        const TetQuality tet = tet_quality(nodes[0], nodes[1], nodes[2], nodes[3]);
        one = {tet.volume_mm3, tet.min_dihedral_deg, tet.max_dihedral_deg,
               block.shape == ElementShape::kTet4 ? tet.scaled_jacobian
                                                  : scaled_jacobian(block.shape, nodes)};
        all.min_radius_ratio =
            tets == 0 ? tet.radius_ratio : std::min(all.min_radius_ratio, tet.radius_ratio);
        radius_ratios += tet.radius_ratio;
        ++tets;
      } else {
        const auto [min_deg, max_deg] = dihedral_range_deg(block.shape, nodes);
        one = {volume_of(block.shape, nodes), min_deg, max_deg,
               scaled_jacobian(block.shape, nodes)};
      }
      if (!(one.volume_mm3 > 0.0 && one.scaled_jacobian > 0.0))
        all.inverted.push_back(all.elements);
      add(all, one);
      add(of_shape->second, one);
    }
  }
  finish(all);
  for (auto& [shape, summary] : all.by_shape) finish(summary);
  if (tets > 0) all.mean_radius_ratio = radius_ratios / double(tets);
  return all;
}

}  // namespace lefort::mesh
