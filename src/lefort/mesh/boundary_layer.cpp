#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/geometry/bvh.h>
#include <lefort/mesh/boundary_faces.h>
#include <lefort/mesh/boundary_layer.h>
#include <lefort/mesh/element_quality.h>
#include <lefort/mesh/improve_tets.h>
#include <lefort/mesh/internal/users_of_nodes.h>

#include <Eigen/SparseCore>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace lefort::mesh {
namespace {

using internal::Lists;
using internal::users_of_nodes;
using Laplacian = Eigen::SparseMatrix<double, Eigen::RowMajor, Index>;
using Shifts =
    Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;  ///< One row per node [mm].

constexpr double kOnSide_mm = 0.05;          // Boundary nodes lie on their level within 0.01 mm.
constexpr double kRoomFraction = 1.0 / 3.0;  // Of the way through the body, at most.
constexpr double kSteepest = 0.5;            // Change of thickness over distance.
constexpr double kThinnest = 0.33;           // Share of the thickness; less is left out.
constexpr double kQualityFraction =
    0.6;                           // Of min_scaled_jacobian, for the layer: it is flat by nature.
constexpr double kAsBefore = 0.9;  // Elements that were as bad before are not the layer's doing.
constexpr double kThinning = 0.7;  // Factor where an element is too bad.

/// \returns an orthonormal basis of what the vectors span, those nearly among the others left out.
std::vector<Vec3> orthonormal(const std::vector<Vec3>& vectors) {
  constexpr double kIndependent = 0.1;  // Sine of the angle.
  std::vector<Vec3> basis;
  for (Vec3 v : vectors) {
    for (const Vec3& b : basis) v -= b.dot(v) * b;
    if (v.norm() > kIndependent) basis.push_back(v.normalized());
  }
  return basis;
}

bool lies_on(const Vec3& p_L, const HalfSpace& side) {
  return std::abs(side.normal.normalized().dot(p_L - side.point)) <= kOnSide_mm;
}

/// The layer while it is made. Nodes of the mesh that are not skin have no thickness.
class BoundaryLayerBuilder {
 public:
  BoundaryLayerBuilder(const VolumeMesh& tets, std::span<const Face> skin,
                       std::span<const HalfSpace> sides, const BoundaryLayerOptions& options)
      : options_(options),
        inner_(tets),
        outer_L_(tets.nodes_L),
        boundary_(triangles_of(boundary_faces(tets))),
        skin_(triangles_of(skin)),
        faces_of_node_(users_of_nodes(tets.node_count(), Index(skin_.size()),
                                      [&](Index f) { return skin_[std::size_t(f)]; })),
        tets_of_node_(users_of_nodes(tets.node_count(), tets.element_count(),
                                     [&](Index e) { return nodes_of(e); })),
        inwards_(outer_L_.size(), Vec3::Zero()),
        thickness_mm_(outer_L_.size(), 0.0) {
    find_freedom(sides);
    find_laplacian();
    find_directions();
    find_thickness();
  }

  /// Moves the skin's nodes in and lets the others give way: by the harmonic function that takes
  /// the skin's shift, so that a shift that is linear in space squeezes all elements alike.
  void displace_interior() {
    const Index count = Index(outer_L_.size());
    Shifts shift = Shifts::Zero(count, 3);
    for (Index n = 0; n < count; ++n)
      shift.row(n) = thickness_mm_[std::size_t(n)] * inwards_[std::size_t(n)].transpose();
    // Conjugate gradients, preconditioned by the diagonal, in the shifts that are allowed.
    constexpr int kMaxIterations = 200;
    constexpr double kTolerance = 1e-3;  // Of the first residual: elements need no more.
    Shifts residual = free_part(-times_laplacian(shift));
    Shifts z = free_part(residual.array().colwise() / diagonal_.array());
    Shifts direction = z;
    double rz = inner_product(residual, z);
    const double enough = kTolerance * kTolerance * rz;
    for (int i = 0; i < kMaxIterations && rz > enough; ++i) {
      const Shifts forced = free_part(times_laplacian(direction));
      const double step = rz / inner_product(direction, forced);
      shift += step * direction;
      residual -= step * forced;
      z = free_part(residual.array().colwise() / diagonal_.array());
      const double before = std::exchange(rz, inner_product(residual, z));
      direction = z + rz / before * direction;
    }
    for (Index n = 0; n < count; ++n)
      inner_.nodes_L[std::size_t(n)] = outer_L_[std::size_t(n)] + shift.row(n).transpose();
  }

  /// Betters the shapes of tetrahedra by moving the nodes inside.
  void improve() {
    std::vector<char> fixed_nodes(outer_L_.size(), 0);
    for (const auto& face : boundary_)
      for (const std::int32_t node : face) fixed_nodes[std::size_t(node)] = 1;
    improve_tets(inner_, [](const Vec3&) { return true; },
                 {.with_jacobian = true, .fixed_nodes = fixed_nodes});
  }

  /// Makes the layer thinner where an element is too bad. \returns how many nodes that changed.
  Index thin() {
    std::vector<char> is_near(outer_L_.size(), 0);
    const ElementBlock& block = inner_.blocks[0];
    std::vector<char> is_poor(std::size_t(block.element_count()), 0);
    parallel_for(block.element_count(), [&](Index e) {
      const double quality = quality_of(nodes_of(e), inner_.nodes_L);
      is_poor[std::size_t(e)] = char(quality < options_.min_scaled_jacobian &&
                                     quality < kAsBefore * quality_of(nodes_of(e), outer_L_));
    });
    for (Index e = 0; e < block.element_count(); ++e)
      if (is_poor[std::size_t(e)] != 0) mark_neighborhood(e, is_near);
    std::vector<char> is_poor_face(skin_.size(), 0);
    parallel_for(Index(skin_.size()), [&](Index f) {
      is_poor_face[std::size_t(f)] = char(quality_of_column(skin_[std::size_t(f)]) <
                                          kQualityFraction * options_.min_scaled_jacobian);
    });
    for (std::size_t f = 0; f < skin_.size(); ++f)
      if (is_poor_face[f] != 0)
        for (const std::int32_t node : skin_[f]) is_near[std::size_t(node)] = 1;

    Index changed = 0;
    for (std::size_t n = 0; n < is_near.size(); ++n) {
      if (is_near[n] == 0 || thickness_mm_[n] == 0.0) continue;
      set_thickness(n, kThinning * thickness_mm_[n]);
      ++changed;
    }
    return changed;
  }

  /// The tetrahedra with the layer over them.
  [[nodiscard]] VolumeMesh result() const {
    VolumeMesh mesh = inner_;
    const int layers = options_.layers;
    std::vector<std::int32_t> first_above(outer_L_.size(), -1);  // Of the node's outer copies.
    for (std::size_t n = 0; n < outer_L_.size(); ++n) {
      if (thickness_mm_[n] == 0.0) continue;
      first_above[n] = std::int32_t(mesh.nodes_L.size());
      for (int level = 0; level < layers; ++level) mesh.nodes_L.push_back(at_level(n, level));
    }
    const auto number = [&](std::int32_t node, int level) {
      const std::int32_t first = first_above[std::size_t(node)];
      return first < 0 || level == layers ? node : first + level;
    };
    std::array<ElementBlock, 3> blocks{};  // By how many corners have no thickness.
    blocks[0].shape = ElementShape::kWedge6;
    blocks[1].shape = ElementShape::kPyramid5;
    for (const Face3& face : skin_)
      for_each_element(face, [&](std::size_t kind, std::span<const Corner> corners) {
        for (const Corner& corner : corners)
          blocks[kind].nodes.push_back(number(corner.node, corner.level));
        blocks[kind].region.push_back(options_.region);
      });
    const auto append = [](std::vector<std::int32_t>& to, const std::vector<std::int32_t>& more) {
      to.insert(to.end(), more.begin(), more.end());
    };
    append(mesh.blocks[0].nodes, blocks[2].nodes);
    append(mesh.blocks[0].region, blocks[2].region);
    for (const std::size_t kind : {1, 0})
      if (blocks[kind].element_count() > 0) mesh.blocks.push_back(std::move(blocks[kind]));
    return mesh;
  }

 private:
  /// A node of an element of the layer: a node of the skin, and how deep, 0 to options.layers.
  struct Corner {
    std::int32_t node;
    int level;
  };

  [[nodiscard]] std::span<const std::int32_t> nodes_of(Index e) const {
    return {inner_.blocks[0].element(e), 4};
  }
  [[nodiscard]] Vec3 allowed(std::size_t node, Vec3 shift) const {
    for (const Vec3& n : blocked_directions_[node]) shift -= n.dot(shift) * n;
    return shift;
  }
  [[nodiscard]] Vec3 at_level(std::size_t node, int level) const {
    const double fraction = double(level) / options_.layers;
    return outer_L_[node] + fraction * thickness_mm_[node] * inwards_[node];
  }
  void set_thickness(std::size_t node, double thickness_mm) {
    thickness_mm_[node] = thickness_mm < kThinnest * options_.thickness_mm ? 0.0 : thickness_mm;
  }

  [[nodiscard]] static double quality_of(std::span<const std::int32_t> tet,
                                         const std::vector<Vec3>& nodes_L) {
    std::array<Vec3, 4> points;
    for (std::size_t n = 0; n < 4; ++n) points[n] = nodes_L[std::size_t(tet[n])];
    return scaled_jacobian(ElementShape::kTet4, points);
  }

  [[nodiscard]] double quality_of_column(const Face3& face) const {
    double worst = 1.0;
    for_each_element(face, [&](std::size_t kind, std::span<const Corner> corners) {
      static constexpr std::array kShapes{ElementShape::kWedge6, ElementShape::kPyramid5,
                                          ElementShape::kTet4};
      std::array<Vec3, 6> points;
      for (std::size_t n = 0; n < corners.size(); ++n)
        points[n] = at_level(std::size_t(corners[n].node), corners[n].level);
      worst =
          std::min(worst, scaled_jacobian(kShapes[kind], std::span(points).first(corners.size())));
    });
    return worst;
  }

  /// Calls visit(corners without thickness, nodes) for the elements between the outer face and the
  /// inner one, from outside in.
  template <class Visit>
  void for_each_element(const Face3& face, const Visit& visit) const {
    const auto is_single = [&](std::int32_t node) {
      return thickness_mm_[std::size_t(node)] == 0.0;
    };
    const auto singles = std::size_t(std::count_if(face.begin(), face.end(), is_single));
    if (singles == 3) return;
    auto [a, b, c] = face;  // Turned so that c is the single node of one, a the double one of two.
    while ((singles == 1 && !is_single(c)) || (singles == 2 && is_single(a))) {
      const std::int32_t first = a;
      a = b, b = c, c = first;
    }
    for (int level = 0; level < options_.layers; ++level) {
      const Corner a0{a, level}, b0{b, level}, c0{c, level};
      const Corner a1{a, level + 1}, b1{b, level + 1}, c1{c, level + 1};
      if (singles == 0) visit(singles, std::array{a0, b0, c0, a1, b1, c1});
      if (singles == 1) visit(singles, std::array{a0, b0, b1, a1, c0});
      if (singles == 2) visit(singles, std::array{a0, c0, b0, a1});
    }
  }

  /// Marks the nodes of the element; if none is of the skin, those of the elements around it.
  void mark_neighborhood(Index element, std::vector<char>& is_near) const {
    bool is_at_skin = false;
    for (const std::int32_t node : nodes_of(element)) {
      is_near[std::size_t(node)] = 1;
      if (thickness_mm_[std::size_t(node)] > 0.0) is_at_skin = true;
    }
    if (is_at_skin) return;
    for (const std::int32_t node : nodes_of(element))
      for (const Index e : tets_of_node_.of(std::size_t(node)))
        for (const std::int32_t other : nodes_of(e)) is_near[std::size_t(other)] = 1;
  }

  void find_freedom(std::span<const HalfSpace> sides) {
    const auto ordered = [](Face3 face) {
      std::sort(face.begin(), face.end());
      return face;
    };
    std::vector<Face3> skin = skin_;
    std::transform(skin.begin(), skin.end(), skin.begin(), ordered);
    std::sort(skin.begin(), skin.end());
    blocked_directions_.resize(outer_L_.size());
    is_layer_boundary_.assign(outer_L_.size(), 0);
    for (const Face3& face : boundary_) {
      if (std::binary_search(skin.begin(), skin.end(), ordered(face))) continue;
      bool is_of_side = false;
      for (const HalfSpace& side : sides) {
        if (!is_cut_face(outer_L_, face, side)) continue;
        is_of_side = true;
        for (const std::int32_t node : face)
          if (lies_on(outer_L_[std::size_t(node)], side))
            blocked_directions_[std::size_t(node)].push_back(side.normal.normalized());
          else
            is_layer_boundary_[std::size_t(node)] =
                1;  // Of a bevel: wedges would end beside the side.
      }
      if (is_of_side) continue;
      for (const std::int32_t node : face) is_layer_boundary_[std::size_t(node)] = 1;
    }
    for (std::vector<Vec3>& normals : blocked_directions_) normals = orthonormal(normals);
    is_fixed_ = is_layer_boundary_;
    for (const Face3& face : skin_)
      for (const std::int32_t node : face) is_fixed_[std::size_t(node)] = 1;
  }

  /// Of linear elements, at rest.
  void find_laplacian() {
    std::vector<Eigen::Triplet<double, Index>> entries;
    entries.reserve(std::size_t(16 * inner_.element_count()));
    for (Index e = 0; e < inner_.element_count(); ++e) {
      const auto nodes = nodes_of(e);
      Mat3 edges;
      for (Index n = 0; n < 3; ++n)
        edges.col(n) =
            outer_L_[std::size_t(nodes[std::size_t(n) + 1])] - outer_L_[std::size_t(nodes[0])];
      Eigen::Matrix<double, 4, 3> gradients;
      gradients.bottomRows<3>() = edges.inverse();
      gradients.row(0) = -gradients.bottomRows<3>().colwise().sum();
      const Eigen::Matrix4d part = edges.determinant() / 6.0 * gradients * gradients.transpose();
      for (Index i = 0; i < 4; ++i)
        for (Index j = 0; j < 4; ++j)
          entries.emplace_back(nodes[std::size_t(i)], nodes[std::size_t(j)], part(i, j));
    }
    laplacian_.resize(Index(outer_L_.size()), Index(outer_L_.size()));
    laplacian_.setFromTriplets(entries.begin(), entries.end());
    diagonal_ = laplacian_.diagonal();
    diagonal_ = (diagonal_.array() > 0.0).select(diagonal_, 1.0);  // Nodes of no element.
  }

  [[nodiscard]] Shifts times_laplacian(const Shifts& shift) const {
    Shifts product(shift.rows(), 3);
    parallel_for(shift.rows(), [&](Index n) {
      Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
      for (Laplacian::InnerIterator entry(laplacian_, n); entry; ++entry)
        sum += entry.value() * shift.row(entry.col());
      product.row(n) = sum;
    });
    return product;
  }

  /// What is left of `shift` of nodes that are not held, along the sides of those there.
  [[nodiscard]] Shifts free_part(Shifts shift) const {
    parallel_for(shift.rows(), [&](Index n) {
      const auto node = std::size_t(n);
      shift.row(n) = is_fixed_[node] != 0
                         ? Eigen::RowVector3d::Zero().eval()
                         : allowed(node, shift.row(n).transpose()).transpose().eval();
    });
    return shift;
  }

  [[nodiscard]] static double inner_product(const Shifts& a, const Shifts& b) {
    return deterministic_sum(a.rows(), 0.0, [&](Index n) { return a.row(n).dot(b.row(n)); });
  }

  [[nodiscard]] Vec3 area_of(Index f) const {
    const auto& [a, b, c] = skin_[std::size_t(f)];
    const Vec3& p = outer_L_[std::size_t(a)];
    return 0.5 * (outer_L_[std::size_t(b)] - p).cross(outer_L_[std::size_t(c)] - p);
  }

  void find_directions() {
    for (std::size_t n = 0; n < outer_L_.size(); ++n) {
      Vec3 sum = Vec3::Zero();
      for (const Index f : faces_of_node_.of(n)) sum -= area_of(f);
      if (sum.norm() > 0.0) inwards_[n] = sum.normalized();
    }
    constexpr int kSmoothings = 3;
    std::vector<Vec3> next = inwards_;
    for (int i = 0; i < kSmoothings; ++i) {
      parallel_for(Index(outer_L_.size()), [&](Index n) {
        const auto node = std::size_t(n);
        Vec3 sum = Vec3::Zero();
        for (const Index f : faces_of_node_.of(node))
          for (const std::int32_t other : skin_[std::size_t(f)])
            sum += inwards_[std::size_t(other)];
        if (sum.norm() > 0.0) next[node] = sum.normalized();
      });
      std::swap(inwards_, next);
    }
    for (std::size_t n = 0; n < outer_L_.size(); ++n) turn_to_worst_face(n);
    for (std::size_t n = 0; n < outer_L_.size(); ++n) {
      const Vec3 along = allowed(n, inwards_[n]);
      constexpr double kTooFlat = 0.3;  // Sine of the angle between skin and side.
      inwards_[n] = along.norm() > kTooFlat ? along.normalized() : Vec3::Zero();
    }
  }

  /// Turns the node's direction until it is not too oblique to any face around it, if that can be.
  void turn_to_worst_face(std::size_t node) {
    constexpr int kMaxTurns = 30;
    constexpr double kSteepEnough = 0.7, kTurn = 0.2;  // Cosine; share of the worst face's normal.
    for (int turn = 0; turn < kMaxTurns; ++turn) {
      double minimum = kSteepEnough;
      Vec3 worst = Vec3::Zero();
      for (const Index f : faces_of_node_.of(node)) {
        const Vec3 inward = -area_of(f).normalized();
        if (const double cosine = inward.dot(inwards_[node]); cosine < minimum) {
          minimum = cosine;
          worst = inward;
        }
      }
      if (worst.isZero()) return;
      inwards_[node] = (inwards_[node] + kTurn * worst).normalized();
    }
  }

  void find_thickness() {
    const geometry::Bvh body({outer_L_, boundary_});
    parallel_for(Index(outer_L_.size()), [&](Index n) {
      const auto node = std::size_t(n);
      if (faces_of_node_.of(node).empty() || is_layer_boundary_[node] != 0 ||
          inwards_[node].isZero())
        return;
      const double start_mm = 0.1 * options_.thickness_mm;
      // A ray along a side would meet the side itself, whose faces lie in their plane but roughly.
      Vec3 from_L = outer_L_[node] + start_mm * inwards_[node];
      for (const Vec3& inside : blocked_directions_[node])
        from_L += std::max(start_mm, 2.0 * kOnSide_mm) * inside;
      const auto other_side = body.first_hit(from_L, inwards_[node]);
      const double room_mm = other_side ? other_side->distance_mm + start_mm : 0.0;
      thickness_mm_[node] = std::min(options_.thickness_mm, kRoomFraction * room_mm);
    });
    for (bool any = true; any;) {
      any = false;
      for (const Face3& face : skin_)
        for (const std::int32_t a : face)
          for (const std::int32_t b : face) {
            double& at_a = thickness_mm_[std::size_t(a)];
            const double max_mm =
                thickness_mm_[std::size_t(b)] +
                kSteepest * (outer_L_[std::size_t(a)] - outer_L_[std::size_t(b)]).norm();
            if (!(at_a > max_mm)) continue;
            at_a = max_mm;
            any = true;
          }
    }
    for (std::size_t n = 0; n < outer_L_.size(); ++n) set_thickness(n, thickness_mm_[n]);
  }

  BoundaryLayerOptions options_;
  VolumeMesh inner_;
  std::vector<Vec3> outer_L_;  ///< Where the nodes were.
  std::vector<Face3> boundary_, skin_;
  Lists faces_of_node_;  ///< Of the skin.
  Lists tets_of_node_;
  std::vector<std::vector<Vec3>>
      blocked_directions_;  ///< Orthonormal directions a node must not move in.
  std::vector<char> is_fixed_, is_layer_boundary_;
  Laplacian laplacian_;
  VectorX diagonal_;
  std::vector<Vec3> inwards_;
  std::vector<double> thickness_mm_;
};

Result<void> check(const BoundaryLayerOptions& options) {
  if (!(options.thickness_mm > 0.0 && options.thickness_mm < 1e3))
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("the skin's thickness is {} mm, must be above 0", options.thickness_mm));
  if (!(options.layers >= 1 && options.layers <= 8))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("the skin has {} layers, must have 1 to 8", options.layers));
  if (!(options.min_scaled_jacobian >= 0.0 && options.min_scaled_jacobian <= 0.5))
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("smallest_jacobian is {}, must be 0 to 0.5", options.min_scaled_jacobian));
  return {};
}

}  // namespace

bool is_cut_face(std::span<const Vec3> nodes_L, const Face3& face, const HalfSpace& side) {
  const auto at = [&](std::size_t corner) { return nodes_L[std::size_t(face[corner])]; };
  const Vec3 outward = (at(1) - at(0)).cross(at(2) - at(0)).normalized();
  return -outward.dot(side.normal.normalized()) > std::numbers::sqrt2 / 2.0 &&
         (lies_on(at(0), side) || lies_on(at(1), side) || lies_on(at(2), side));
}

Result<VolumeMesh> add_boundary_layer(const VolumeMesh& tets, std::span<const Face> skin,
                                      std::span<const HalfSpace> sides,
                                      const BoundaryLayerOptions& options, Progress& progress) {
  LEFORT_CHECK(tets.blocks.size() == 1 && tets.blocks[0].shape == ElementShape::kTet4);
  LEFORT_TRY_VOID(check(options));
  BoundaryLayerBuilder maker(tets, skin, sides, options);
  constexpr int kMaxRounds = 30;
  bool is_settled = false;
  for (int round = 0; round < kMaxRounds && !is_settled; ++round) {
    if (progress.stop_requested())
      return fail(ErrorCode::kCancelled, "meshing the skin was cancelled");
    progress.report(double(round) / kMaxRounds);
    maker.displace_interior();  // Anew: where nothing is left of the layer the mesh is what it was.
    maker.improve();
    is_settled = maker.thin() == 0;
  }
  if (!is_settled)
    return fail(ErrorCode::kMeshingFailed,
                fmt::format("the layer of skin still gets thinner after {} rounds", kMaxRounds));
  VolumeMesh mesh = maker.result();
  if (const auto bad = poor_elements(mesh, 0.0); !bad.empty())
    return fail(ErrorCode::kMeshingFailed,
                fmt::format("{} of {} elements under the skin have no volume, none may", bad.size(),
                            mesh.element_count()));
  progress.report(1.0);
  return mesh;
}

}  // namespace lefort::mesh
