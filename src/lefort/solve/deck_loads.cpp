#include <lefort/core/check.h>
#include <lefort/solve/deck_loads.h>

#include <utility>

namespace lefort::solve {
namespace {

/// Total force of a term on the body: minus the sum of its residual.
Vec3 total_force_n(const fem::ForceTerm& term, std::span<const Vec3> x_L) {
  Vec3 total_n = Vec3::Zero();
  std::vector<Vec3> local_x_L;
  VectorX residual_n;
  for (Index item = 0; item < term.item_count(); ++item) {
    const std::span<const std::int32_t> nodes = term.nodes(item);
    local_x_L.clear();
    for (const std::int32_t node : nodes) local_x_L.push_back(x_L[std::size_t(node)]);
    residual_n = VectorX::Zero(Index(3 * nodes.size()));
    fem::LocalEquations local{.residual_n = {residual_n.data(), residual_n.size()},
                              .stiffness_n_per_mm = {nullptr, 0, 0}};
    LEFORT_CHECK(term.evaluate(item, local_x_L, local));
    total_n -= residual_n.reshaped(3, Index(nodes.size())).rowwise().sum();
  }
  return total_n;
}

}  // namespace

Result<DeckLoads> DeckLoads::build(const PreparedDeck& prepared) {
  const Deck& deck = prepared.deck;
  const std::vector<Vec3>& nodes_L = prepared.mesh.nodes_L;
  DeckLoads loads;
  for (std::size_t i = 0; i < deck.tractions.size(); ++i) {
    LEFORT_TRY(const auto forces, fem::traction_forces(nodes_L, prepared.traction_faces[i],
                                                       deck.tractions[i].traction_mpa));
    loads.tractions_.push_back(std::make_unique<fem::DeadLoad>(nodes_L, forces));
    loads.traction_curves_.push_back(deck.tractions[i].curve);
  }
  for (std::size_t i = 0; i < deck.pressures.size(); ++i) {
    LEFORT_TRY(auto pressure, fem::FollowerPressure::build(nodes_L, prepared.pressure_faces[i]));
    loads.pressures_.push_back(std::move(pressure));
    loads.pressure_curves_.push_back(deck.pressures[i].curve);
    loads.pressures_mpa_.push_back(deck.pressures[i].pressure_mpa);
  }
  for (std::size_t i = 0; i < deck.body_forces.size(); ++i) {
    fem::RegionBodyForces per_volume;
    for (const std::int32_t region : prepared.body_force_regions[i])
      per_volume[region] =
          prepared.density_t_per_mm3.at(region) * deck.body_forces[i].acceleration_mm_per_s2;
    LEFORT_TRY(const auto forces, fem::body_forces(prepared.mesh, per_volume));
    loads.body_forces_.push_back(std::make_unique<fem::DeadLoad>(nodes_L, forces));
    loads.body_force_curves_.push_back(deck.body_forces[i].curve);
  }
  loads.set_time(0.0);
  return loads;
}

void DeckLoads::set_time(double time) {
  for (std::size_t i = 0; i < tractions_.size(); ++i)
    tractions_[i]->set_factor(factor_at(traction_curves_[i], time));
  for (std::size_t i = 0; i < pressures_.size(); ++i)
    pressures_[i]->set_pressure_mpa(pressures_mpa_[i] * factor_at(pressure_curves_[i], time));
  for (std::size_t i = 0; i < body_forces_.size(); ++i)
    body_forces_[i]->set_factor(factor_at(body_force_curves_[i], time));
}

std::vector<const fem::ForceTerm*> DeckLoads::terms() const {
  std::vector<const fem::ForceTerm*> terms;
  for (const auto& term : tractions_) terms.push_back(term.get());
  for (const auto& term : pressures_) terms.push_back(term.get());
  for (const auto& term : body_forces_) terms.push_back(term.get());
  return terms;
}

std::vector<Vec3> DeckLoads::totals_n(std::span<const Vec3> x_L) const {
  std::vector<Vec3> totals_n;
  for (const fem::ForceTerm* term : terms()) totals_n.push_back(total_force_n(*term, x_L));
  return totals_n;
}

}  // namespace lefort::solve
