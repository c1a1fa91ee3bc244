/// \file
/// The figures of all benchmarks in one list, and their comparison with stored ones.
#pragma once

#include <nlohmann/json.hpp>

#include <span>
#include <string>
#include <vector>

namespace lefort::bench {

/// A result of a benchmark.
struct Figure {
  std::string name;
  double value = 0.0;
  std::string unit = "times";  ///< "times": a ratio to `peer` in the same run.
  std::string peer = "";       ///< Empty: there is none.

  /// Ratios to peers depend less on the machine than times do; only they are compared with stored
  /// ones.
  [[nodiscard]] bool is_ratio() const { return unit == "times"; }
};

/// Build time and queries of fields over those of OpenVDB, by resolution; the gain by a second
/// thread.
/// \param table1  table1.json of run_table1().
[[nodiscard]] std::vector<Figure> figures_of_table1(const nlohmann::ordered_json& table1);

/// Queries over those of CGAL's AABB tree, by processor time.
/// \param detection  detection.json of run_detection().
[[nodiscard]] std::vector<Figure> figures_of_detection(const nlohmann::ordered_json& detection);

/// Time of CalculiX over ours, and the exponents of growth.
/// \param solve  solve.json of run_solve_bench().
[[nodiscard]] std::vector<Figure> figures_of_solve(const nlohmann::ordered_json& solve);

/// Time of CalculiX over ours for the ball on a block, the faster of both of our formulations. No
/// ratio for comparison with stored ones: CalculiX runs once.
/// \param contact  contact.json of run_contact_bench().
[[nodiscard]] std::vector<Figure> figures_of_contact(const nlohmann::ordered_json& contact);

/// Compares ratios with those of an earlier run.
///
/// \param figures    measured.
/// \param stored     {"figures": {name: ratio}}, as of to_json().
/// \param threshold  allowed loss, as a fraction of the stored ratio.
/// \returns a sentence for each ratio that is lower by more than the threshold, or missing.
[[nodiscard]] std::vector<std::string> find_regressions(std::span<const Figure> figures,
                                                        const nlohmann::ordered_json& stored,
                                                        double threshold);

/// \returns {"figures": ratios, "others": all other figures}.
[[nodiscard]] nlohmann::ordered_json to_json(std::span<const Figure> figures);

/// \param stored  as for find_regressions(), or null.
/// \returns a table in Markdown.
[[nodiscard]] std::string figure_table(std::span<const Figure> figures,
                                       const nlohmann::ordered_json& stored);

}  // namespace lefort::bench
