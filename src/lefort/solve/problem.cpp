#include <lefort/core/check.h>
#include <lefort/fem/assembly/element_state.h>
#include <lefort/solve/problem.h>

#include <algorithm>
#include <limits>
#include <utility>

namespace lefort::solve {

std::vector<WeightedContact> make_weighted_contacts(
    const PreparedDeck& prepared, std::span<const contact::RigidObstacle> obstacles) {
  std::vector<std::vector<std::size_t>> groups;
  for (std::size_t i = 0; i < obstacles.size(); ++i) {
    if (prepared.deck.obstacles[i].integration != contact::Integration::kWeighted) continue;
    const auto same = std::find_if(groups.begin(), groups.end(), [&](const auto& group) {
      const std::size_t first = group[0];
      return prepared.obstacle_faces[first] == prepared.obstacle_faces[i] &&
             prepared.obstacle_stiffness_mpa_per_mm[first] ==
                 prepared.obstacle_stiffness_mpa_per_mm[i] &&
             prepared.deck.obstacles[first].contact_snap_mm ==
                 prepared.deck.obstacles[i].contact_snap_mm;
    });
    if (same == groups.end())
      groups.push_back({i});
    else
      same->push_back(i);
  }
  std::vector<WeightedContact> contacts;
  for (std::vector<std::size_t>& group : groups) {
    const std::size_t first = group[0];
    std::vector<contact::RigidObstacle> of_group;
    of_group.reserve(group.size());
    for (const std::size_t i : group) of_group.push_back(obstacles[i]);
    contacts.push_back({std::move(group),
                        {prepared.mesh.nodes_L,
                         prepared.obstacle_faces[first],
                         std::move(of_group),
                         {.stiffness_mpa_per_mm = prepared.obstacle_stiffness_mpa_per_mm[first],
                          .contact_snap_mm = prepared.deck.obstacles[first].contact_snap_mm}}});
  }
  return contacts;
}

Increment Problem::describe(const fem::LoadState& state) const {
  const Deck& deck = prepared_.deck;
  const std::vector<Vec3> x_L = contact::displaced(prepared_.mesh.nodes_L, state.u);
  Increment increment;
  increment.time = state.t;
  increment.u = state.u;
  increment.elements = fem::element_states(prepared_.mesh, prepared_.materials, state.u);
  increment.min_J = std::numeric_limits<double>::infinity();
  for (const fem::ElementState& element : increment.elements)
    increment.min_J = std::min(increment.min_J, element.min_volume_ratio);
  for (Index n = 0; n < prepared_.mesh.node_count(); ++n)
    increment.max_displacement_mm =
        std::max(increment.max_displacement_mm, state.u.segment<3>(3 * n).norm());

  const auto forces = assembler_.forces(state.u);
  LEFORT_CHECK(forces.has_value());
  increment.energy_mj = forces->energy_mj;
  increment.reactions_n.assign(deck.displacements.size() + deck.motions.size(), Vec3::Zero());
  for (const PrescribedDof& prescribed : prepared_.prescribed)
    if (prescribed.by >= 0)
      increment.reactions_n[std::size_t(prescribed.by)][prescribed.component] +=
          forces->residual_n[3 * Index(prescribed.node) + prescribed.component];
  increment.loads_n = loads_.totals_n(x_L);
  increment.contacts.resize(obstacles_.size());
  increment.nodal_contacts.resize(obstacles_.size());
  for (std::size_t n = 0; n < contacts_.size(); ++n) {
    increment.contacts[contact_obstacles_[n]] = contacts_[n].summarize(x_L);
    increment.nodal_contacts[contact_obstacles_[n]] = contacts_[n].at_nodes(x_L);
  }
  for (const WeightedContact& contact : weighted_) {
    const auto sums = contact.term.summarize(x_L);
    const auto nodes = contact.term.at_nodes_by_bone(x_L);
    for (std::size_t n = 0; n < contact.obstacles.size(); ++n) {
      increment.contacts[contact.obstacles[n]] = sums[n];
      increment.nodal_contacts[contact.obstacles[n]] = nodes[n];
    }
  }
  for (const ProbePlace& probe : prepared_.probes)
    increment.probes_mm.push_back(displacement_of(probe, state.u));
  return increment;
}

}  // namespace lefort::solve
