#include <lefort/core/parallel.h>
#include <lefort/field/build/triangle_tree.h>
#include <lefort/geometry/closest_point.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace lefort::field {

namespace {

/// Margin of boxes as a fraction of the largest coordinate: some units in the last place of a
/// float, and of the points compared with them.
constexpr float kWiden = 4e-7F;

using Center = std::array<float, 3>;

struct Splitter {
  const std::vector<TriangleTree::Node>& of_triangle;  ///< Boxes of the triangles.
  const std::vector<Center>& centers;
  TriangleTree& tree;

  void split(std::int32_t begin, std::int32_t end) {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    TriangleTree::Node node{{kInfinity, kInfinity, kInfinity},
                            {-kInfinity, -kInfinity, -kInfinity},
                            begin,
                            end - begin};
    Center minimum = node.low, maximum = node.high;
    for (std::int32_t i = begin; i < end; ++i) {
      const auto t = std::size_t(tree.order[std::size_t(i)]);
      for (std::size_t k = 0; k < 3; ++k) {
        node.low[k] = std::min(node.low[k], of_triangle[t].low[k]);
        node.high[k] = std::max(node.high[k], of_triangle[t].high[k]);
        minimum[k] = std::min(minimum[k], centers[t][k]);
        maximum[k] = std::max(maximum[k], centers[t][k]);
      }
    }
    const std::size_t position = tree.nodes.size();
    tree.nodes.push_back(node);
    if (end - begin <= TriangleTree::kLeafTriangles) {
      std::sort(tree.order.begin() + begin, tree.order.begin() + end);
      return;
    }
    std::size_t axis = 0;
    for (std::size_t k = 1; k < 3; ++k)
      if (maximum[k] - minimum[k] > maximum[axis] - minimum[axis]) axis = k;
    const std::int32_t middle = begin + (end - begin) / 2;
    std::nth_element(tree.order.begin() + begin, tree.order.begin() + middle,
                     tree.order.begin() + end, [&](std::int32_t s, std::int32_t t) {
                       const float x = centers[std::size_t(s)][axis];
                       const float y = centers[std::size_t(t)][axis];
                       return x != y ? x < y : s < t;
                     });
    split(begin, middle);
    tree.nodes[position].first = std::int32_t(tree.nodes.size());
    tree.nodes[position].count = 0;
    split(middle, end);
  }
};

}  // namespace

TriangleTree build_triangle_tree(const geometry::TriangleMesh& mesh, const Vec3& origin) {
  const auto count = std::size_t(mesh.triangle_count());
  std::vector<TriangleTree::Node> boxes(count);
  std::vector<Center> centers(count);
  parallel_for(mesh.triangle_count(), [&](Index t) {
    TriangleTree::Node& box = boxes[std::size_t(t)];
    for (int k = 0; k < 3; ++k) {
      const auto [minimum, maximum] =
          std::minmax({mesh.corner(t, 0)[k], mesh.corner(t, 1)[k], mesh.corner(t, 2)[k]});
      const auto low = float(minimum - origin[k]), high = float(maximum - origin[k]);
      const float wide = kWiden * std::max(std::abs(low), std::abs(high));
      box.low[std::size_t(k)] = low - wide;
      box.high[std::size_t(k)] = high + wide;
      centers[std::size_t(t)][std::size_t(k)] = 0.5F * (low + high);
    }
  });
  TriangleTree tree{origin, {}, std::vector<std::int32_t>(count)};
  std::iota(tree.order.begin(), tree.order.end(), 0);
  tree.nodes.reserve(count / 2 + 1);
  Splitter{boxes, centers, tree}.split(0, std::int32_t(count));
  return tree;
}

double squared_distance(const geometry::TriangleMesh& mesh, const TriangleTree& tree, const Vec3& p,
                        double max_distance_mm) {
  const Vec3 from_origin = p - tree.origin;
  const auto to_box = [&](std::int32_t n) {
    const TriangleTree::Node& node = tree.nodes[std::size_t(n)];
    double sum = 0.0;
    for (int k = 0; k < 3; ++k) {
      const double off = std::max({double(node.low[std::size_t(k)]) - from_origin[k],
                                   from_origin[k] - double(node.high[std::size_t(k)]), 0.0});
      sum += off * off;
    }
    return sum;
  };
  double best = max_distance_mm * max_distance_mm;
  bool found = false;
  std::array<std::int32_t, TriangleTree::kStackSize> stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const std::int32_t n = stack[--depth];
    if (to_box(n) > best) continue;
    const TriangleTree::Node& node = tree.nodes[std::size_t(n)];
    if (node.count == 0) {
      const bool second_is_nearer = to_box(node.first) < to_box(n + 1);
      stack[depth++] = second_is_nearer ? n + 1 : node.first;
      stack[depth++] = second_is_nearer ? node.first : n + 1;
      continue;
    }
    for (std::int32_t i = node.first; i < node.first + node.count; ++i) {
      const std::int32_t t = tree.order[std::size_t(i)];
      const double squared = geometry::closest_point_on_triangle(
                                 p, mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2))
                                 .squared_distance_mm2;
      if (!(squared <= best)) continue;
      best = squared;
      found = true;
    }
  }
  return found ? best : std::numeric_limits<double>::infinity();
}

}  // namespace lefort::field
