#include <lefort/core/units.h>
#include <lefort/geometry/rigid_path.h>
#include <lefort/io/deck_file.h>
#include <lefort/io/deck_schema.h>
#include <lefort/io/deprecated_keys.h>
#include <lefort/io/internal/read_contact.h>
#include <lefort/io/internal/read_law.h>
#include <lefort/io/internal/validated_json.h>
#include <lefort/io/read_text.h>

#include <fmt/format.h>

#include <map>
#include <set>
#include <utility>

namespace lefort::io {
namespace {

using internal::as_vector;
using internal::Json;
using internal::list;
using internal::read;
using internal::section;
namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxDeck = 64 << 20;  // Bytes; node lists and curves may be long.

constexpr double kTonnesPerMm3 = 1e-12;  // Of one kg/m^3.
constexpr double kMmPerS2 = 1e3;         // Of one m/s^2.
constexpr int kObstacleResolution = 128;

tl::unexpected<Error> refuse(const std::string& key, const std::string& why) {
  return fail(ErrorCode::kPlanInvalid, fmt::format("{}: {}", key, why));
}

std::string indexed(const char* list, std::size_t index) {
  return fmt::format("{}[{}]", list, index);
}

std::string region_name(const Json& object) {
  const auto region = object.find("region");
  if (region == object.end()) return {};
  return region->is_string() ? region->get<std::string>()
                             : fmt::format("{}", region->get<std::int64_t>());
}

Result<solve::LoadCurve> read_curve(const Json& object, const std::string& key) {
  solve::LoadCurve curve;
  const auto json = object.find("curve");
  if (json == object.end()) return curve;
  curve.points.clear();
  for (const Json& point : *json)
    curve.points.push_back({point[0].get<double>(), point[1].get<double>()});
  if (const auto checked = check_curve(curve); !checked)
    return refuse(key + ".curve", checked.error().message);
  return curve;
}

/// Standing still unless keyframes are given.
Result<geometry::RigidPath> read_path(const Json& object, const std::string& name,
                                      const std::string& key) {
  geometry::RigidPath path;
  path.segment = name;
  path.steps = 1;
  path.keyframes = object.contains("keyframes")
                       ? internal::read_keyframes(object["keyframes"], "time")
                       : std::vector<geometry::Keyframe>{geometry::Keyframe{}};
  if (const auto checked = geometry::check_path(path); !checked)
    return refuse(key + ".keyframes", checked.error().message);
  return path;
}

Result<solve::SetChoice> read_set(const std::string& name, const Json& json) {
  const std::string key = "sets." + name;
  if (name.empty()) return refuse("sets", "a set has no name");
  if (json.contains("box_mm")) {
    const Vec3 low = as_vector(json["box_mm"][0]), high = as_vector(json["box_mm"][1]);
    if ((low.array() > high.array()).any())
      return refuse(key, "the first corner of box_mm must not lie beyond the second");
    return solve::SetChoice{name, solve::NodesInBox{Box3(low, high)}};
  }
  if (json.contains("plane")) {
    solve::NodesOnPlane plane;
    read(json["plane"], "point_mm", plane.point_L);
    read(json["plane"], "normal", plane.normal_L);
    read(json["plane"], "within_mm", plane.within_mm);
    if (!(plane.normal_L.norm() > 1e-9)) return refuse(key + ".plane.normal", "the vector is zero");
    plane.normal_L.normalize();
    return solve::SetChoice{name, plane};
  }
  if (json.contains("nodes"))
    return solve::SetChoice{name,
                            solve::NodesByNumber{json["nodes"].get<std::vector<std::int32_t>>()}};
  if (json.contains("nearest_mm"))
    return solve::SetChoice{name, solve::NodeNearest{as_vector(json["nearest_mm"])}};
  return solve::SetChoice{name, solve::NodesOfRegion{region_name(json)}};
}

Result<void> read_body(const Json& json, solve::Deck& deck) {
  const Json& sets = section(json, "sets");
  for (const auto& [name, choice] : sets.items()) {
    LEFORT_TRY(solve::SetChoice set, read_set(name, choice));
    deck.sets.push_back(std::move(set));
  }
  const Json& materials = list(json, "materials");
  for (std::size_t i = 0; i < materials.size(); ++i) {
    auto law = internal::read_law(materials[i]);
    if (!law) return refuse(indexed("materials", i), law.error().message);
    deck.laws.push_back({region_name(materials[i]), *std::move(law),
                         kTonnesPerMm3 * materials[i].value("density_kg_m3", 0.0)});
  }
  return {};
}

Result<void> read_supports(const Json& json, solve::Deck& deck) {
  const Json& displacements = list(json, "displacements");
  for (std::size_t i = 0; i < displacements.size(); ++i) {
    const std::string key = indexed("displacements", i);
    solve::PrescribedSet set;
    read(displacements[i], "set", set.set);
    bool holds = false;
    for (std::size_t component = 0; component < 3; ++component) {
      const std::string name = std::string(1, "xyz"[component]) + "_mm";
      if (!displacements[i].contains(name)) continue;
      set.displacement_mm[component] = displacements[i][name].get<double>();
      holds = true;
    }
    if (!holds) return refuse(key, "none of x_mm, y_mm, z_mm is given");
    LEFORT_TRY(set.curve, read_curve(displacements[i], key));
    deck.displacements.push_back(std::move(set));
  }
  const Json& motions = list(json, "motions");
  for (std::size_t i = 0; i < motions.size(); ++i) {
    solve::RigidlyMovedSet set;
    read(motions[i], "set", set.set);
    LEFORT_TRY(set.path, read_path(motions[i], set.set, indexed("motions", i)));
    deck.motions.push_back(std::move(set));
  }
  return {};
}

Result<void> read_loads(const Json& json, solve::Deck& deck) {
  const Json& tractions = list(json, "tractions");
  for (std::size_t i = 0; i < tractions.size(); ++i) {
    solve::Traction load;
    read(tractions[i], "faces", load.faces);
    load.traction_mpa = as_vector(tractions[i]["traction_kpa"]) * mpa_from_kpa(1.0);
    LEFORT_TRY(load.curve, read_curve(tractions[i], indexed("tractions", i)));
    deck.tractions.push_back(std::move(load));
  }
  const Json& pressures = list(json, "pressures");
  for (std::size_t i = 0; i < pressures.size(); ++i) {
    solve::PressureLoad load;
    read(pressures[i], "faces", load.faces);
    load.pressure_mpa = mpa_from_kpa(pressures[i]["pressure_kpa"].get<double>());
    LEFORT_TRY(load.curve, read_curve(pressures[i], indexed("pressures", i)));
    deck.pressures.push_back(std::move(load));
  }
  const Json& body_forces = list(json, "body_forces");
  for (std::size_t i = 0; i < body_forces.size(); ++i) {
    solve::BodyForce load;
    load.region = region_name(body_forces[i]);
    load.acceleration_mm_per_s2 = as_vector(body_forces[i]["acceleration_m_s2"]) * kMmPerS2;
    LEFORT_TRY(load.curve, read_curve(body_forces[i], indexed("body_forces", i)));
    deck.body_forces.push_back(std::move(load));
  }
  return {};
}

Result<void> read_obstacles(const Json& json, const fs::path& folder, DeckFile& file) {
  const Json& obstacles = list(json, "obstacles");
  std::set<std::string> names;
  for (std::size_t i = 0; i < obstacles.size(); ++i) {
    const Json& object = obstacles[i];
    const std::string key = indexed("obstacles", i);
    solve::Obstacle obstacle;
    read(object, "name", obstacle.name);
    if (!names.insert(obstacle.name).second)
      return refuse(key, fmt::format("the name {} stands twice", obstacle.name));
    read(object, "faces", obstacle.faces);
    LEFORT_TRY(obstacle.path, read_path(object, obstacle.name, key));
    if (object.contains("stiffness_kpa_per_mm"))
      obstacle.stiffness_mpa_per_mm = mpa_from_kpa(object["stiffness_kpa_per_mm"].get<double>());
    read(object, "stiffness_factor", obstacle.stiffness_factor);
    read(object, "contact_snap_mm", obstacle.contact_snap_mm);
    internal::read_contact(object, obstacle);
    ObstacleFile source;
    source.file = folder / object["file"].get<std::string>();
    source.options.resolution = kObstacleResolution;
    source.options.smooth = obstacle.detection == contact::DetectionMethod::kSmooth;
    read(object, "resolution", source.options.resolution);
    read(object, "band_mm", source.options.band_mm);
    file.obstacles.push_back(std::move(source));
    file.deck.obstacles.push_back(std::move(obstacle));
  }
  return {};
}

Result<void> read_control(const Json& json, DeckFile& file) {
  const Json& steps = section(json, "steps");
  fem::LoadStepOptions& options = file.deck.steps;
  options.max_increment = 1.0;
  read(steps, "max_increment", options.max_increment);
  options.first_increment = std::min(options.first_increment, options.max_increment);
  read(steps, "initial_increment", options.first_increment);
  options.min_increment = std::min(options.min_increment, options.first_increment);
  read(steps, "min_increment", options.min_increment);
  read(steps, "growth_factor", options.growth_factor);
  read(steps, "target_iterations", options.target_iterations);
  read(steps, "max_attempts", options.max_attempts);
  read(steps, "times", file.deck.times);
  if (options.min_increment > options.first_increment)
    return refuse("steps.min_increment",
                  fmt::format("{:g} is more than steps.initial_increment, {:g}",
                              options.min_increment, options.first_increment));
  if (options.first_increment > options.max_increment)
    return refuse("steps.initial_increment",
                  fmt::format("{:g} is more than steps.max_increment, {:g}",
                              options.first_increment, options.max_increment));

  using linear::LinearSolverKind;
  const std::map<std::string, LinearSolverKind> kinds{{"automatic", LinearSolverKind::kAutomatic},
                                                      {"direct", LinearSolverKind::kDirect},
                                                      {"lagged", LinearSolverKind::kReusedFactor},
                                                      {"multigrid", LinearSolverKind::kMultigrid}};
  file.deck.linear_solver.kind = kinds.at(json.value("linear_solver", "automatic"));

  const Json& newton = section(json, "newton");
  read(newton, "relative_tolerance", file.deck.newton.relative_tolerance);
  read(newton, "max_iterations", file.deck.newton.max_iterations);
  if (newton.contains("absolute_tolerance_n"))
    file.deck.newton.absolute_tolerance_n = newton["absolute_tolerance_n"].get<double>();
  return {};
}

Result<void> read_results(const Json& json, DeckFile& file) {
  std::set<std::string> names;
  const Json& probes = list(json, "probes");
  for (std::size_t i = 0; i < probes.size(); ++i) {
    solve::Probe probe;
    read(probes[i], "name", probe.name);
    if (!names.insert(probe.name).second)
      return refuse(indexed("probes", i), fmt::format("the name {} stands twice", probe.name));
    if (probes[i].contains("node"))
      probe.at = probes[i]["node"].get<std::int32_t>();
    else
      probe.at = as_vector(probes[i]["point_mm"]);
    file.deck.probes.push_back(std::move(probe));
  }
  const Json& output = section(json, "output");
  const std::string every = output.value("every", "increment");
  file.every = every == "last"    ? WriteEvery::kLast
               : every == "times" ? WriteEvery::kRequestedTime
                                  : WriteEvery::kIncrement;
  if (file.every == WriteEvery::kRequestedTime && file.deck.times.empty())
    return refuse("output.every", "times needs steps.times");
  if (const auto fields = output.find("fields"); fields != output.end()) {
    const auto chosen = fields->get<std::set<std::string>>();
    // Not a rule of the schema: the validator compares all pairs and keeps a message for each.
    if (chosen.size() != fields->size()) return refuse("output.fields", "a field stands twice");
    file.fields = {.displacement = chosen.contains("displacement"),
                   .stress = chosen.contains("stress"),
                   .volume_ratio = chosen.contains("volume_ratio"),
                   .stretches = chosen.contains("stretches"),
                   .energy = chosen.contains("energy"),
                   .contact = chosen.contains("contact")};
  }
  return {};
}

}  // namespace

Result<DeckFile> parse_deck(std::string_view text, const fs::path& folder) {
  LEFORT_TRY(internal::CheckedJson checked,
             internal::parse_checked(text, kDeckSchema, "the deck", deprecated_in_decks()));
  const Json& json = checked.json;
  DeckFile file;
  file.warnings = std::move(checked.warnings);
  read(json, "title", file.title);
  file.mesh = folder / json["mesh"].get<std::string>();
  read(json, "regions", file.regions);
  read(json, "mm_per_unit", file.mm_per_unit);
  LEFORT_TRY_VOID(read_body(json, file.deck));
  LEFORT_TRY_VOID(read_supports(json, file.deck));
  LEFORT_TRY_VOID(read_loads(json, file.deck));
  LEFORT_TRY_VOID(read_obstacles(json, folder, file));
  LEFORT_TRY_VOID(read_control(json, file));
  LEFORT_TRY_VOID(read_results(json, file));
  return file;
}

Result<DeckText> read_deck(const fs::path& file) {
  LEFORT_TRY(std::string text, read_text(file, kMaxDeck));
  std::error_code error;
  const fs::path absolute = fs::absolute(file, error);
  Result<DeckFile> deck = parse_deck(text, (error ? file : absolute).parent_path());
  if (!deck)
    return fail(deck.error().code, fmt::format("deck {}: {}", file.string(), deck.error().message));
  return DeckText{*std::move(deck), std::move(text)};
}

}  // namespace lefort::io
