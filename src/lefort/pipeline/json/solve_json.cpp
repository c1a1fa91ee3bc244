#include <lefort/core/units.h>
#include <lefort/core/version.h>
#include <lefort/pipeline/json/json_values.h>
#include <lefort/pipeline/json/newton_json.h>
#include <lefort/pipeline/json/solve_json.h>
#include <lefort/pipeline/timing/peak_memory.h>

#include <fmt/format.h>

#include <algorithm>

namespace lefort::pipeline {
namespace {

using Json = nlohmann::ordered_json;

using pipeline::as_json;

/// Names of conditions and loads, in the order of Increment::reactions_n and loads_n.
struct Names {
  std::vector<std::string> conditions, loads;
};

Names names_of(const solve::Deck& deck) {
  Names names;
  const auto conditions = deck.displacements.size() + deck.motions.size();
  for (std::size_t i = 0; i < conditions; ++i)
    names.conditions.push_back(solve::name_of_condition(deck, int(i)));
  for (std::size_t i = 0; i < deck.tractions.size(); ++i)
    names.loads.push_back(fmt::format("tractions[{}] (faces {})", i, deck.tractions[i].faces));
  for (std::size_t i = 0; i < deck.pressures.size(); ++i)
    names.loads.push_back(fmt::format("pressures[{}] (faces {})", i, deck.pressures[i].faces));
  for (std::size_t i = 0; i < deck.body_forces.size(); ++i)
    names.loads.push_back(fmt::format("body_forces[{}]", i));
  return names;
}

Json forces_json(const std::vector<std::string>& names, const std::vector<Vec3>& forces_n) {
  Json json = Json::object();
  for (std::size_t i = 0; i < names.size(); ++i) json[names[i]] = as_json(forces_n[i]);
  return json;
}

Json contacts_json(const solve::Deck& deck, const solve::Increment& increment) {
  Json json = Json::object();
  for (std::size_t i = 0; i < deck.obstacles.size(); ++i)
    json[deck.obstacles[i].name] = contact_json(increment.contacts[i]);
  return json;
}

Json sets_json(const mesh::VolumeMesh& mesh) {
  Json nodes = Json::object(), faces = Json::object();
  for (const auto& [name, set] : mesh.node_sets) nodes[name] = set.size();
  for (const auto& [name, set] : mesh.face_sets) faces[name] = set.size();
  return {{"node_sets", nodes}, {"face_sets", faces}};
}

Json mesh_json(const solve::PreparedDeck& prepared) {
  Json regions = Json::array();
  for (const auto& [region, law] : prepared.materials) regions.push_back(region);
  Json json{{"nodes", prepared.mesh.node_count()},
            {"elements", prepared.mesh.element_count()},
            {"free_components", 3 * prepared.mesh.node_count() - Index(prepared.prescribed.size())},
            {"regions", regions}};
  json.update(sets_json(prepared.mesh));
  return json;
}

Json stiffnesses_json(const solve::PreparedDeck& prepared) {
  Json json = Json::object();
  for (std::size_t i = 0; i < prepared.deck.obstacles.size(); ++i)
    json[prepared.deck.obstacles[i].name] = kpa_from_mpa(prepared.obstacle_stiffness_mpa_per_mm[i]);
  return json;
}

Json seconds_json(const PhaseClock& clock) {
  Json phases = Json::object();
  double total = 0.0;
  for (const auto& [name, seconds] : clock.seconds()) {
    phases[name] = seconds;
    total += seconds;
  }
  return {
      {"total_seconds", total}, {"phase_seconds", phases}, {"peak_memory_mb", peak_memory_mb()}};
}

std::string name_of(linear::LinearSolverKind kind) {
  switch (kind) {
    case linear::LinearSolverKind::kAutomatic:
      return "automatic";
    case linear::LinearSolverKind::kDirect:
      return "direct";
    case linear::LinearSolverKind::kReusedFactor:
      return "lagged";
    case linear::LinearSolverKind::kMultigrid:
      break;
  }
  return "multigrid";
}

Json linear_solver_json(const solve::PreparedDeck& prepared, const solve::DeckRun& run) {
  const Json used = run.linear_solver ? Json(name_of(*run.linear_solver)) : Json(nullptr);
  return {{"requested", name_of(prepared.deck.linear_solver.kind)}, {"used", used}};
}

/// Files and names of the results; a run that ended early has no final state.
Json last_converged_json(const solve::DeckRun& run, const std::string& file) {
  if (!run.last) return nullptr;
  return {{"increment", run.last->number},
          {"time", run.last->time},
          {"file", file},
          {"is_final", run.completed()}};
}

}  // namespace

Json increment_json(const solve::PreparedDeck& prepared, const solve::Increment& increment) {
  const Names names = names_of(prepared.deck);
  Vec3 reaction_n = Vec3::Zero();
  for (const Vec3& force_n : increment.reactions_n) reaction_n += force_n;
  Vec3 load_n = Vec3::Zero();
  for (const Vec3& force_n : increment.loads_n) load_n += force_n;
  return {{"increment", increment.number},
          {"time", increment.time},
          {"energy_mj", increment.energy_mj},
          {"residual_n", increment.residual_n},
          {"relative_residual", increment.relative_residual},
          {"max_displacement_mm", increment.max_displacement_mm},
          {"min_volume_ratio", increment.min_J},
          {"reactions_n", forces_json(names.conditions, increment.reactions_n)},
          {"reaction_sum_n", as_json(reaction_n)},
          {"loads_n", forces_json(names.loads, increment.loads_n)},
          {"load_sum_n", as_json(load_n)},
          {"contacts", contacts_json(prepared.deck, increment)},
          {"attempts", attempts_json(increment.attempts)}};
}

Json inputs_json(const solve::PreparedDeck& prepared, const SolveInputs& inputs) {
  Json obstacles = Json::object();
  for (std::size_t i = 0; i < inputs.obstacle_sha256.size(); ++i)
    obstacles[prepared.deck.obstacles[i].name] = inputs.obstacle_sha256[i];
  return {{"deck_sha256", inputs.deck_sha256},
          {"mesh_sha256", inputs.mesh_sha256},
          {"obstacles_sha256", std::move(obstacles)}};
}

Json solve_json(const io::DeckFile& file, const solve::PreparedDeck& prepared,
                const SolveInputs& inputs, Json increments, const solve::DeckRun& run,
                const std::string& last_file, const PhaseClock& clock) {
  Json json{{"lefort_solve", 2},
            {"notice", kNotForClinicalUse},
            {"version", kVersion},
            {"title", file.title},
            {"completed", run.completed()},
            {"converged", !run.failure || run.failure->code == ErrorCode::kCancelled},
            {"time_reached", run.last ? run.last->time : 0.0},
            {"last_converged", last_converged_json(run, last_file)},
            {"inputs", inputs_json(prepared, inputs)},
            {"mesh", mesh_json(prepared)},
            {"newton",
             {{"relative_tolerance", prepared.deck.newton.relative_tolerance},
              {"absolute_tolerance_n", prepared.deck.newton.absolute_tolerance_n},
              {"max_iterations", prepared.deck.newton.max_iterations}}},
            {"linear_solver", linear_solver_json(prepared, run)},
            {"contact_stiffness_kpa_per_mm", stiffnesses_json(prepared)},
            {"warnings", prepared.warnings},
            {"increments", std::move(increments)}};
  if (run.failure) {
    json["failure"] = run.failure->message;
    json["failed_attempts"] = attempts_json(run.failed_attempts);
  }
  json["timing"] = seconds_json(clock);
  return json;
}

}  // namespace lefort::pipeline
