#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/mesh/boundary_faces.h>
#include <lefort/mesh/boundary_layer.h>
#include <lefort/mesh/element_quality.h>
#include <lefort/mesh/improve_tets.h>
#include <lefort/mesh/internal/harmonic_extension.h>
#include <lefort/mesh/internal/layer_constraints.h>
#include <lefort/mesh/internal/layer_directions.h>
#include <lefort/mesh/internal/layer_elements.h>
#include <lefort/mesh/internal/layer_surface.h>
#include <lefort/mesh/internal/limit_thickness.h>
#include <lefort/mesh/internal/users_of_nodes.h>

#include <fmt/format.h>

#include <array>
#include <numbers>
#include <vector>

namespace lefort::mesh {
namespace {

using internal::LayerSurface;
using internal::Lists;
using internal::users_of_nodes;

// Heuristic values, without a source in the literature.
// A node with less than this fraction of the thickness becomes single: omitted, not thin.
constexpr double kMinThicknessFraction = 0.33;
// Of min_scaled_jacobian, for elements of the layer: they are flatter than tetrahedra by design.
constexpr double kLayerQualityFraction = 0.6;
// The layer gets thinner at a poor tetrahedron only if its quality is below this fraction of the
// initial one.
constexpr double kQualityLoss = 0.9;
constexpr double kThinningFactor = 0.7;  // Per round; a node becomes single in the fourth.
constexpr int kMaxThinningRounds = 30;

LayerSurface layer_surface(const VolumeMesh& tets, std::span<const Face> skin) {
  LayerSurface surface{tets.nodes_L, triangles_of(skin), {}};
  surface.faces_of_node = users_of_nodes(tets.node_count(), Index(surface.faces.size()),
                                         [&](Index f) { return surface.faces[std::size_t(f)]; });
  return surface;
}

double quality_of_tet(const std::int32_t* tet, const std::vector<Vec3>& nodes_L) {
  std::array<Vec3, 4> points;
  for (std::size_t n = 0; n < 4; ++n) points[n] = nodes_L[std::size_t(tet[n])];
  return scaled_jacobian(ElementShape::kTet4, points);
}

/// The layer and the tetrahedra below it while its thickness is reduced.
class BoundaryLayerBuilder {
 public:
  BoundaryLayerBuilder(const VolumeMesh& tets, std::span<const Face> skin,
                       std::span<const HalfSpace> cut_planes, const BoundaryLayerOptions& options)
      : options_(options),
        inner_(tets),
        surface_(layer_surface(tets, skin)),
        boundary_(triangles_of(boundary_faces(tets))),
        tets_of_node_(users_of_nodes(tets.node_count(), tets.element_count(),
                                     [&](Index e) { return nodes_of(e); })),
        constraints_(surface_, boundary_, cut_planes),
        extension_(tets, constraints_),
        layer_(surface_, inward_directions(surface_, constraints_), options.layers) {
    const std::vector<double> limited_mm = internal::limited_thickness_mm(
        surface_, boundary_, constraints_, layer_.inwards(), options.thickness_mm);
    for (std::size_t n = 0; n < limited_mm.size(); ++n) set_thickness(n, limited_mm[n]);
  }

  BoundaryLayerBuilder(const BoundaryLayerBuilder&) = delete;
  BoundaryLayerBuilder& operator=(const BoundaryLayerBuilder&) = delete;

  /// Moves the covered nodes to the inner surface of the layer and the nodes below harmonically,
  /// always from their initial positions: where no layer is left, the mesh is unchanged.
  void displace_interior() {
    const Index count = Index(surface_.nodes_L.size());
    internal::Displacements prescribed = internal::Displacements::Zero(count, 3);
    for (Index n = 0; n < count; ++n)
      prescribed.row(n) = layer_.displacement(std::size_t(n)).transpose();
    const internal::Displacements displacements = extension_.solve(prescribed);
    for (Index n = 0; n < count; ++n)
      inner_.nodes_L[std::size_t(n)] =
          surface_.nodes_L[std::size_t(n)] + displacements.row(n).transpose();
  }

  /// Improves the shapes of tetrahedra by moving interior nodes.
  void improve_interior() {
    std::vector<char> fixed_nodes(surface_.nodes_L.size(), 0);
    for (const auto& face : boundary_)
      for (const std::int32_t node : face) fixed_nodes[std::size_t(node)] = 1;
    improve_tets(inner_, [](const Vec3&) { return true; },
                 {.with_jacobian = true, .fixed_nodes = fixed_nodes});
  }

  /// Reduces the thickness near elements of insufficient quality.
  /// \returns the number of nodes whose thickness was reduced.
  Index thin() {
    std::vector<char> is_near(surface_.nodes_L.size(), 0);
    mark_poor_tets(is_near);
    mark_poor_faces(is_near);
    Index changed = 0;
    for (std::size_t n = 0; n < is_near.size(); ++n) {
      if (is_near[n] == 0 || layer_.is_single(n)) continue;
      set_thickness(n, kThinningFactor * layer_.thickness_mm(n));
      ++changed;
    }
    return changed;
  }

  /// \returns the tetrahedra with the layer over them.
  [[nodiscard]] VolumeMesh result() const { return layer_.add_to(inner_, options_.region); }

 private:
  [[nodiscard]] std::span<const std::int32_t> nodes_of(Index e) const {
    return {inner_.blocks[0].element(e), 4};
  }

  void set_thickness(std::size_t node, double thickness_mm) {
    const bool is_too_thin = thickness_mm < kMinThicknessFraction * options_.thickness_mm;
    layer_.set_thickness_mm(node, is_too_thin ? 0.0 : thickness_mm);
  }

  void mark_poor_tets(std::vector<char>& is_near) const {
    const ElementBlock& block = inner_.blocks[0];
    std::vector<char> is_poor(std::size_t(block.element_count()), 0);
    parallel_for(block.element_count(), [&](Index e) {
      const double quality = quality_of_tet(block.element(e), inner_.nodes_L);
      is_poor[std::size_t(e)] =
          char(quality < options_.min_scaled_jacobian &&
               quality < kQualityLoss * quality_of_tet(block.element(e), surface_.nodes_L));
    });
    for (Index e = 0; e < block.element_count(); ++e)
      if (is_poor[std::size_t(e)] != 0) mark_neighborhood(e, is_near);
  }

  void mark_poor_faces(std::vector<char>& is_near) const {
    const std::vector<Face3>& faces = surface_.faces;
    std::vector<char> is_poor(faces.size(), 0);
    parallel_for(Index(faces.size()), [&](Index f) {
      is_poor[std::size_t(f)] = char(layer_.min_scaled_jacobian(faces[std::size_t(f)]) <
                                     kLayerQualityFraction * options_.min_scaled_jacobian);
    });
    for (std::size_t f = 0; f < faces.size(); ++f)
      if (is_poor[f] != 0)
        for (const std::int32_t node : faces[f]) is_near[std::size_t(node)] = 1;
  }

  /// Marks the nodes of the element; if none has a thickness, also those of adjacent elements.
  void mark_neighborhood(Index element, std::vector<char>& is_near) const {
    bool is_at_layer = false;
    for (const std::int32_t node : nodes_of(element)) {
      is_near[std::size_t(node)] = 1;
      if (layer_.thickness_mm(std::size_t(node)) > 0.0) is_at_layer = true;
    }
    if (is_at_layer) return;
    for (const std::int32_t node : nodes_of(element))
      for (const Index e : tets_of_node_.of(std::size_t(node)))
        for (const std::int32_t other : nodes_of(e)) is_near[std::size_t(other)] = 1;
  }

  BoundaryLayerOptions options_;
  VolumeMesh inner_;
  LayerSurface surface_;
  std::vector<Face3> boundary_;
  Lists tets_of_node_;
  internal::LayerConstraints constraints_;
  internal::HarmonicExtension extension_;
  internal::LayerElements layer_;
};

Result<void> check(const BoundaryLayerOptions& options) {
  if (!(options.thickness_mm > 0.0 && options.thickness_mm < 1e3))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("the thickness of the boundary layer is {} mm, must be above 0 and "
                            "below 1000",
                            options.thickness_mm));
  if (!(options.layers >= 1 && options.layers <= 8))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("the number of boundary layers is {}, must be 1 to 8", options.layers));
  if (!(options.min_scaled_jacobian >= 0.0 && options.min_scaled_jacobian <= 0.5))
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("min_scaled_jacobian is {}, must be 0 to 0.5", options.min_scaled_jacobian));
  return {};
}

}  // namespace

bool is_cut_face(std::span<const Vec3> nodes_L, const Face3& face, const HalfSpace& plane) {
  const auto at = [&](std::size_t corner) { return nodes_L[std::size_t(face[corner])]; };
  const Vec3 outward = (at(1) - at(0)).cross(at(2) - at(0)).normalized();
  return -outward.dot(plane.normal.normalized()) > std::numbers::sqrt2 / 2.0 &&
         (internal::lies_on(at(0), plane) || internal::lies_on(at(1), plane) ||
          internal::lies_on(at(2), plane));
}

Result<VolumeMesh> add_boundary_layer(const VolumeMesh& tets, std::span<const Face> skin,
                                      std::span<const HalfSpace> cut_planes,
                                      const BoundaryLayerOptions& options, Progress& progress) {
  LEFORT_CHECK(tets.blocks.size() == 1 && tets.blocks[0].shape == ElementShape::kTet4);
  LEFORT_TRY_VOID(check(options));
  BoundaryLayerBuilder builder(tets, skin, cut_planes, options);
  bool is_finished = false;
  for (int round = 0; round < kMaxThinningRounds && !is_finished; ++round) {
    if (progress.stop_requested())
      return fail(ErrorCode::kCancelled, "meshing the boundary layer was cancelled");
    progress.report(double(round) / kMaxThinningRounds);
    builder.displace_interior();
    builder.improve_interior();
    is_finished = builder.thin() == 0;
  }
  if (!is_finished)
    return fail(
        ErrorCode::kMeshingFailed,
        fmt::format("the boundary layer still gets thinner after {} rounds", kMaxThinningRounds));
  VolumeMesh mesh = builder.result();
  if (const auto bad = poor_elements(mesh, 0.0); !bad.empty())
    return fail(ErrorCode::kMeshingFailed,
                fmt::format("{} of {} elements of the mesh with the boundary layer are inverted or "
                            "have no volume",
                            bad.size(), mesh.element_count()));
  progress.report(1.0);
  return mesh;
}

}  // namespace lefort::mesh
