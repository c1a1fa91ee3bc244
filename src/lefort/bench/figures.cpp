#include <lefort/bench/figures.h>

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>

namespace lefort::bench {
namespace {

using Json = nlohmann::ordered_json;

/// A number, if the pointer exists.
std::optional<double> number_at(const Json& json, const std::string& pointer) {
  const Json::json_pointer at(pointer);
  if (!json.contains(at) || !json.at(at).is_number()) return std::nullopt;
  return json.at(at).get<double>();
}

void add_ratio(const std::string& name, const std::string& peer, std::optional<double> dividend,
               std::optional<double> divisor, std::vector<Figure>& figures) {
  if (dividend && divisor && *divisor > 0.0)
    figures.push_back({.name = name, .value = *dividend / *divisor, .peer = peer});
}

/// A number of a run in table1.json.
std::optional<double> table1_number(const Json& table1, const std::string& method, int resolution,
                                    int threads, const std::string& pointer) {
  for (const Json& run : table1)
    if (run.at("method") == method && run.at("resolution") == resolution &&
        run.at("threads") == threads)
      return number_at(run.at("result"), pointer);
  return std::nullopt;
}

}  // namespace

std::vector<Figure> figures_of_table1(const Json& table1) {
  std::set<int> resolutions;
  for (const Json& run : table1) resolutions.insert(run.at("resolution").get<int>());
  std::vector<Figure> figures;
  for (const int n : resolutions) {
    const auto number = [&](const char* method, int threads, const char* pointer) {
      return table1_number(table1, method, n, threads, pointer);
    };
    add_ratio(fmt::format("field of {}³, build", n), "OpenVDB", number("openvdb", 1, "/seconds"),
              number("bricks", 1, "/seconds"), figures);
    add_ratio(fmt::format("field of {}³, queries", n), "OpenVDB",
              number("bricks", 1, "/rates/value"), number("openvdb", 1, "/rates/value"), figures);
    const auto one = number("bricks", 1, "/seconds"), two = number("bricks", 2, "/seconds");
    if (one && two && *two > 0.0)
      figures.push_back({.name = fmt::format("field of {}³, two threads", n),
                         .value = *one / *two,
                         .unit = "times as fast as one"});
  }
  return figures;
}

std::vector<Figure> figures_of_detection(const Json& detection) {
  std::vector<Figure> figures;
  const auto cgal = number_at(detection, "/methods/CGAL AABB tree, unsigned/processor_s");
  for (const auto& [method, measured] : detection.at("methods").items())
    if (method.starts_with("field"))
      add_ratio("contact detection, " + method, "CGAL AABB tree", cgal,
                number_at(measured, "/processor_s"), figures);
  return figures;
}

std::vector<Figure> figures_of_solve(const Json& solve) {
  std::vector<Figure> figures;
  const auto pair = solve.find("pair");
  if (pair != solve.end())
    for (const auto& [name, results] : pair->items())
      if (const auto ratio = number_at(results, "/median_ratio"))
        figures.push_back({.name = fmt::format("solve of a block of {:.0f} unknowns",
                                               pair->at("dofs").get<double>()),
                           .value = *ratio,
                           .peer = "CalculiX, " + name});
  const auto exponents = solve.find("exponents");
  if (exponents != solve.end())
    for (const auto& [name, results] : exponents->items())
      if (const auto seconds = number_at(results, "/seconds"))
        figures.push_back({.name = fmt::format("growth of the time of a solve, {}", name),
                           .value = *seconds,
                           .unit = "exponent of the unknowns"});
  return figures;
}

std::vector<Figure> figures_of_contact(const Json& contact) {
  std::vector<Figure> figures;
  std::optional<double> fastest_s;
  for (const auto& [name, run] : contact.items()) {
    const auto seconds = number_at(run, "/seconds");
    if (!seconds || !name.starts_with("lefort")) continue;
    figures.push_back({.name = "ball on a block, " + name, .value = *seconds, .unit = "s"});
    figures.push_back({.name = "ball on a block, vertical force, " + name,
                       .value = run.at("force_z_n"),
                       .unit = "N"});
    if (!fastest_s || *seconds < *fastest_s) fastest_s = seconds;
  }
  for (const auto& [name, run] : contact.items())
    if (name.starts_with("CalculiX"))
      if (const auto seconds = number_at(run, "/seconds"); seconds && fastest_s)
        figures.push_back({.name = "ball on a block",
                           .value = *seconds / *fastest_s,
                           .unit = "times, one run",
                           .peer = name});
  return figures;
}

namespace {

/// As stored: one name for each pair of a measurement and its peer.
std::string key_of(const Figure& figure) {
  return figure.peer.empty() ? figure.name : fmt::format("{} over {}", figure.name, figure.peer);
}

std::optional<double> stored_value(const Json& stored, const Figure& figure) {
  if (!stored.is_object() || !stored.contains("figures")) return std::nullopt;
  const Json& all = stored.at("figures");
  const auto found = all.find(key_of(figure));
  if (found == all.end() || !found->is_number()) return std::nullopt;
  return found->get<double>();
}

}  // namespace

std::vector<std::string> find_regressions(std::span<const Figure> figures, const Json& stored,
                                          double threshold) {
  std::vector<std::string> sentences;
  std::set<std::string> measured;
  for (const Figure& figure : figures) {
    measured.insert(key_of(figure));
    const auto before = stored_value(stored, figure);
    if (!before || !figure.is_ratio() || figure.value >= (1.0 - threshold) * *before) continue;
    sentences.push_back(
        fmt::format("{}: {:.3g} times, stored {:.3g}", key_of(figure), figure.value, *before));
  }
  if (!stored.is_object() || !stored.contains("figures")) return sentences;
  for (const auto& [name, value] : stored.at("figures").items())
    if (!measured.contains(name))
      sentences.push_back(fmt::format("{}: stored, but not measured", name));
  return sentences;
}

Json to_json(std::span<const Figure> figures) {
  Json ratios = Json::object(), others = Json::object();
  for (const Figure& figure : figures) {
    if (figure.is_ratio())
      ratios[key_of(figure)] = figure.value;
    else
      others[key_of(figure)] = {{"value", figure.value}, {"unit", figure.unit}};
  }
  return {{"figures", std::move(ratios)}, {"others", std::move(others)}};
}

std::string figure_table(std::span<const Figure> figures, const Json& stored) {
  std::string table = "| what | figure | over | stored |\n|---|---|---|---|\n";
  for (const Figure& figure : figures) {
    const auto before = stored_value(stored, figure);
    table += fmt::format("| {} | {:.3g} {} | {} | {} |\n", figure.name, figure.value, figure.unit,
                         figure.peer, before ? fmt::format("{:.3g}", *before) : "");
  }
  return table;
}

}  // namespace lefort::bench
