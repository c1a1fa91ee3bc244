#include <lefort/contact/penalty.h>
#include <lefort/contact/weighted_contact_term.h>
#include <lefort/fem/assembly/element_term.h>
#include <lefort/geometry/rigid_path.h>
#include <lefort/solve/find_sets.h>
#include <lefort/solve/mesh_index.h>
#include <lefort/solve/prefix_error.h>
#include <lefort/solve/prepare_deck.h>
#include <lefort/solve/unconstrained_parts.h>
#include <lefort/solve/warn_of_locking.h>
#include <lefort/solve/young_modulus_at_rest.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <span>
#include <utility>

namespace lefort::solve {
namespace {

using FaceList = std::vector<mesh::Face>;

Result<void> check_mesh(const mesh::VolumeMesh& mesh) {
  for (const mesh::ElementBlock& block : mesh.blocks)
    for (const std::int32_t node : block.nodes)
      if (node < 0 || Index(node) >= mesh.node_count())
        return fail(ErrorCode::kMeshInvalid,
                    fmt::format("an element of the mesh has node {}; the nodes are 0 to {}", node,
                                mesh.node_count() - 1));
  for (const mesh::ElementBlock& block : mesh.blocks)
    if (block.nodes.size() != block.region.size() * std::size_t(mesh::node_count(block.shape)))
      return fail(
          ErrorCode::kMeshInvalid,
          fmt::format("a block of {} elements has {} nodes; it must have {} for each",
                      block.region.size(), block.nodes.size(), mesh::node_count(block.shape)));
  if (mesh.element_count() == 0) return fail(ErrorCode::kMeshInvalid, "the mesh has no element");
  return {};
}

// --- Materials -----------------------------------------------------------------------------------

Index elements_of(const mesh::VolumeMesh& mesh, std::int32_t region) {
  Index count = 0;
  for (const mesh::ElementBlock& block : mesh.blocks)
    count += Index(std::count(block.region.begin(), block.region.end(), region));
  return count;
}

Result<void> assign_laws(PreparedDeck& prepared) {
  const std::vector<RegionLaw>& laws = prepared.deck.laws;
  std::map<std::int32_t, std::size_t> law_of;
  std::optional<std::size_t> rest;
  const auto twice = [](const std::string& what, std::size_t first, std::size_t second) {
    return fail(ErrorCode::kPlanInvalid,
                fmt::format("materials[{}] and materials[{}] are both for {}; only one may be",
                            first, second, what));
  };
  for (std::size_t l = 0; l < laws.size(); ++l) {
    if (laws[l].region.empty()) {
      if (rest) return twice("all other regions", *rest, l);
      rest = l;
      continue;
    }
    LEFORT_TRY(const std::int32_t region,
               prefix_error(find_region(prepared.mesh, laws[l].region), indexed("materials", l)));
    const auto [known, is_new] = law_of.try_emplace(region, l);
    if (!is_new) return twice(fmt::format("region {}", laws[l].region), known->second, l);
  }
  for (const std::int32_t region : regions_of(prepared.mesh)) {
    if (rest) law_of.try_emplace(region, *rest);
    const auto law = law_of.find(region);
    if (law == law_of.end())
      return fail(ErrorCode::kPlanInvalid,
                  fmt::format("materials: region {} of the mesh ({} elements) has no material",
                              region, elements_of(prepared.mesh, region)));
    prepared.materials.emplace(region, laws[law->second].law);
    prepared.density_t_per_mm3.emplace(region, laws[law->second].density_t_per_mm3);
  }
  return {};
}

// --- Loads ---------------------------------------------------------------------------------------

/// Describes a face between two elements; nothing if all faces are on the boundary.
std::optional<std::string> inner_face(const PreparedDeck& prepared, const MeshIndex& index,
                                      const FaceList& faces, const std::string& set) {
  for (const mesh::Face& face : faces)
    if (const auto uses = faces_like(index, face); uses.size() > 1)
      return fmt::format("faces {} contain one between elements {} and {} at {}", set,
                         uses[0].element, uses[1].element, place_of(prepared.mesh, face));
  return std::nullopt;
}

/// Rejects loads along normals inside the body, because the order of the file decides their sign.
Result<void> check_outside(const PreparedDeck& prepared, const MeshIndex& index,
                           const FaceList& faces, const std::string& set) {
  const auto inner = inner_face(prepared, index, faces, set);
  if (!inner) return {};
  return fail(ErrorCode::kPlanInvalid, *inner + "; all must lie on the boundary");
}

Result<void> find_loads(PreparedDeck& prepared, const MeshIndex& index) {
  const Deck& deck = prepared.deck;
  for (std::size_t i = 0; i < deck.tractions.size(); ++i) {
    const std::string key = indexed("tractions", i);
    LEFORT_TRY_VOID(prefix_error(check_curve(deck.tractions[i].curve), key));
    LEFORT_TRY(FaceList faces,
               prefix_error(find_faces(prepared.mesh, deck.tractions[i].faces), key));
    if (const auto inner = inner_face(prepared, index, faces, deck.tractions[i].faces))
      prepared.warnings.push_back(fmt::format("{}: {}", key, *inner));
    prepared.traction_faces.push_back(std::move(faces));
  }
  for (std::size_t i = 0; i < deck.pressures.size(); ++i) {
    const std::string key = indexed("pressures", i);
    LEFORT_TRY_VOID(prefix_error(check_curve(deck.pressures[i].curve), key));
    LEFORT_TRY(FaceList faces,
               prefix_error(find_faces(prepared.mesh, deck.pressures[i].faces), key));
    LEFORT_TRY_VOID(
        prefix_error(check_outside(prepared, index, faces, deck.pressures[i].faces), key));
    prepared.pressure_faces.push_back(std::move(faces));
  }
  for (std::size_t i = 0; i < deck.body_forces.size(); ++i) {
    const BodyForce& force = deck.body_forces[i];
    const std::string key = indexed("body_forces", i);
    LEFORT_TRY_VOID(prefix_error(check_curve(force.curve), key));
    std::vector<std::int32_t> regions = regions_of(prepared.mesh);
    if (!force.region.empty()) {
      LEFORT_TRY(const std::int32_t region,
                 prefix_error(find_region(prepared.mesh, force.region), key));
      regions = {region};
    }
    for (const std::int32_t region : regions)
      if (!(prepared.density_t_per_mm3.at(region) > 0.0))
        return fail(ErrorCode::kPlanInvalid,
                    fmt::format("{}: the material of region {} has no density_kg_m3", key, region));
    prepared.body_force_regions.push_back(std::move(regions));
  }
  return {};
}

double mean_edge_mm(const mesh::VolumeMesh& mesh, const FaceList& faces) {
  double sum_mm = 0.0;
  Index edges = 0;
  for (const mesh::Face& face : faces) {
    const int corners =
        face.shape == mesh::FaceShape::kTri3 || face.shape == mesh::FaceShape::kTri6 ? 3 : 4;
    for (int a = 0; a < corners; ++a, ++edges)
      sum_mm += (mesh.nodes_L[std::size_t(face.nodes[std::size_t(a)])] -
                 mesh.nodes_L[std::size_t(face.nodes[std::size_t((a + 1) % corners)])])
                    .norm();
  }
  return sum_mm / double(edges);
}

/// Young's modulus of the stiffest region whose elements have one of the faces.
double young_behind_mpa(const PreparedDeck& prepared, const MeshIndex& index,
                        const FaceList& faces) {
  std::set<std::int32_t> regions;
  for (const mesh::Face& face : faces)
    for (const FaceUse& use : faces_like(index, face))
      regions.insert(region_of(prepared.mesh, use.element));
  double young_mpa = 0.0;
  for (const std::int32_t region : regions)
    young_mpa = std::max(young_mpa, young_modulus_at_rest_mpa(prepared.materials.at(region)));
  return young_mpa;
}

double default_stiffness_mpa_per_mm(const Obstacle& obstacle, double young_mpa, double edge_mm) {
  if (obstacle.integration == contact::Integration::kWeighted)
    return contact::weighted_stiffness_mpa_per_mm(
        young_mpa, obstacle.penetration_tolerance_mm.value_or(contact::kWeightedTolerance_mm));
  return obstacle.stiffness_factor * young_mpa / edge_mm;
}

Result<void> find_obstacles(PreparedDeck& prepared, const MeshIndex& index) {
  for (std::size_t i = 0; i < prepared.deck.obstacles.size(); ++i) {
    const Obstacle& obstacle = prepared.deck.obstacles[i];
    const std::string key = indexed("obstacles", i);
    LEFORT_TRY_VOID(prefix_error(geometry::check_path(obstacle.path), key));
    LEFORT_TRY(FaceList faces, prefix_error(find_faces(prepared.mesh, obstacle.faces), key));
    LEFORT_TRY_VOID(prefix_error(check_outside(prepared, index, faces, obstacle.faces), key));
    const double young_mpa = young_behind_mpa(prepared, index, faces);
    prepared.obstacle_stiffness_mpa_per_mm.push_back(obstacle.stiffness_mpa_per_mm.value_or(
        default_stiffness_mpa_per_mm(obstacle, young_mpa, mean_edge_mm(prepared.mesh, faces))));
    const double stiffness_mpa_per_mm = prepared.obstacle_stiffness_mpa_per_mm.back();
    prepared.obstacle_laws.push_back(
        obstacle.penetration_tolerance_mm
            ? contact::hardening_law(stiffness_mpa_per_mm, young_mpa,
                                     *obstacle.penetration_tolerance_mm)
            : contact::PressureLaw{.penalty_mpa_per_mm = stiffness_mpa_per_mm});
    prepared.obstacle_faces.push_back(std::move(faces));
  }
  return {};
}

// --- Time, support -------------------------------------------------------------------------------

void find_levels(PreparedDeck& prepared) {
  const Deck& deck = prepared.deck;
  std::set<double> levels(deck.times.begin(), deck.times.end());
  const auto add_curve = [&](const LoadCurve& curve) {
    for (const CurvePoint& point : curve.points) levels.insert(point.time);
  };
  const auto add_path = [&](const geometry::RigidPath& path) {
    for (const geometry::Keyframe& key : path.keyframes) levels.insert(key.path_fraction);
  };
  for (const PrescribedSet& set : deck.displacements) add_curve(set.curve);
  for (const Traction& load : deck.tractions) add_curve(load.curve);
  for (const PressureLoad& load : deck.pressures) add_curve(load.curve);
  for (const BodyForce& load : deck.body_forces) add_curve(load.curve);
  for (const RigidlyMovedSet& set : deck.motions) add_path(set.path);
  for (const Obstacle& obstacle : deck.obstacles) add_path(obstacle.path);
  // Times that differ only by rounding are one level; the last is 1.
  for (const double level : levels) {
    const double last = prepared.levels.empty() ? 0.0 : prepared.levels.back();
    if (level > last + kSameTime && level < 1.0 - kSameTime) prepared.levels.push_back(level);
  }
  prepared.levels.push_back(1.0);
}

Index unused_nodes(const PreparedDeck& prepared) {
  const std::vector<char> used = nodes_of_elements(prepared.mesh);
  return Index(std::count(used.begin(), used.end(), 0));
}

/// Whether an obstacle may touch one of these nodes.
bool may_be_touched(const PreparedDeck& prepared, const std::vector<std::int32_t>& nodes) {
  for (const FaceList& faces : prepared.obstacle_faces)
    for (const mesh::Face& face : faces)
      if (std::binary_search(nodes.begin(), nodes.end(), face.nodes[0])) return true;
  return false;
}

Result<void> check_supports(PreparedDeck& prepared) {
  for (const UnconstrainedPart& part :
       find_unconstrained_parts(prepared.mesh, prescribed_at(prepared, 0.0))) {
    const std::string what = fmt::format(
        "the part of {} elements around element {} at ({:.3f}, {:.3f}, {:.3f}) mm can {}",
        part.elements, part.first_element, part.at_L.x(), part.at_L.y(), part.at_L.z(),
        part.motion);
    if (!may_be_touched(prepared, part.nodes))
      return fail(ErrorCode::kPlanInvalid,
                  fmt::format("displacements: {} as a rigid body; it is not fixed", what));
    prepared.warnings.push_back(what + " as a rigid body until an obstacle supports it");
  }
  return {};
}

/// Warns of loads that do not start at 0: increments cannot divide the jump at time 0.
void warn_of_jumps(PreparedDeck& prepared) {
  const Deck& deck = prepared.deck;
  const auto check_start = [&](const LoadCurve& curve, const std::string& key) {
    if (factor_at(curve, 0.0) != 0.0)
      prepared.warnings.push_back(fmt::format(
          "{}: the curve begins at {:g}; this part is applied at once, however small the "
          "increments",
          key, factor_at(curve, 0.0)));
  };
  for (std::size_t i = 0; i < deck.displacements.size(); ++i) {
    const auto& mm = deck.displacements[i].displacement_mm;
    if (std::any_of(mm.begin(), mm.end(), [](const auto& u) { return u.value_or(0.0) != 0.0; }))
      check_start(deck.displacements[i].curve, indexed("displacements", i));
  }
  for (std::size_t i = 0; i < deck.tractions.size(); ++i)
    check_start(deck.tractions[i].curve, indexed("tractions", i));
  for (std::size_t i = 0; i < deck.pressures.size(); ++i)
    check_start(deck.pressures[i].curve, indexed("pressures", i));
  for (std::size_t i = 0; i < deck.body_forces.size(); ++i)
    check_start(deck.body_forces[i].curve, indexed("body_forces", i));
}

}  // namespace

Result<PreparedDeck> prepare_deck(mesh::VolumeMesh mesh, Deck deck) {
  LEFORT_TRY_VOID(check_mesh(mesh));
  PreparedDeck prepared;
  const MeshIndex index = index_mesh(mesh);
  LEFORT_TRY(prepared.mesh, add_sets(std::move(mesh), deck.sets));
  prepared.deck = std::move(deck);
  LEFORT_TRY_VOID(prefix_error(fem::validate(prepared.deck.steps), "steps"));
  LEFORT_TRY_VOID(prefix_error(fem::validate(prepared.deck.newton), "newton"));
  LEFORT_TRY_VOID(assign_laws(prepared));
  LEFORT_TRY_VOID(fem::make_element_terms(prepared.mesh, prepared.materials));
  prepared.warnings = warn_of_locking(prepared.mesh, prepared.materials);
  // After the check of single elements: a degenerate one may have the same face twice.
  LEFORT_TRY(const auto joints, check_joints(prepared.mesh, index));
  prepared.warnings.insert(prepared.warnings.end(), joints.begin(), joints.end());
  LEFORT_TRY(prepared.prescribed, find_prescribed_dofs(prepared.mesh, prepared.deck));
  if (const Index unused = unused_nodes(prepared); unused > 0)
    prepared.warnings.push_back(
        fmt::format("{} nodes belong to no element and do not move", unused));
  LEFORT_TRY_VOID(find_loads(prepared, index));
  LEFORT_TRY_VOID(find_obstacles(prepared, index));
  for (std::size_t i = 0; i < prepared.deck.probes.size(); ++i) {
    LEFORT_TRY(ProbePlace place,
               prefix_error(locate_probe(prepared.mesh, prepared.deck.probes[i].at),
                            indexed("probes", i)));
    prepared.probes.push_back(std::move(place));
  }
  find_levels(prepared);
  warn_of_jumps(prepared);
  LEFORT_TRY_VOID(check_supports(prepared));
  return prepared;
}

}  // namespace lefort::solve
