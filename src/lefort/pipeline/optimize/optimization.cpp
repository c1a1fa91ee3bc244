#include <lefort/core/version.h>
#include <lefort/pipeline/json/json_values.h>
#include <lefort/pipeline/optimize/optimization.h>

#include <fmt/format.h>

#include <cmath>

namespace lefort::pipeline {
namespace {

using Json = nlohmann::ordered_json;

Json as_list(const VectorX& x) { return std::vector<double>(x.data(), x.data() + x.size()); }

Json residual_json(const inverse::TargetResidual& of) {
  return {{"rms_mm", of.rms_mm}, {"max_mm", of.max_mm}, {"count", of.count}};
}

/// "midface anterior is at its upper bound, 4 mm".
std::vector<std::string> bounds_against(const Optimization& done, std::size_t target) {
  std::vector<std::string> words;
  const inverse::MotionResult& result = done.result;
  for (Index n = 0; n < done.variables.count(); ++n) {
    const double slope = result.target_gradients(Index(target), n);
    const auto i = std::size_t(n);
    const bool low = result.at_lower[i] != 0 && slope > 0.0;
    const bool high = result.at_upper[i] != 0 && slope < 0.0;
    if (!low && !high) continue;
    words.push_back(fmt::format(
        "{} is at its {} bound, {:g} {}", done.variables.name(n), low ? "lower" : "upper",
        low ? done.variables.lower()[n] : done.variables.upper()[n], done.variables.unit(n)));
  }
  return words;
}

std::string reason_of(const Optimization& done, std::size_t target) {
  std::string words;
  for (const std::string& one : bounds_against(done, target))
    words += (words.empty() ? "" : "; ") + one;
  if (done.result.is_limited_by_overlap) {
    words += words.empty() ? "" : "; ";
    words += done.result.overlap.first.empty()
                 ? "bone overlap limits the movement"
                 : fmt::format("the overlap of {} and {}, {:.2f} mm, limits the movement",
                               done.result.overlap.first, done.result.overlap.second,
                               done.result.overlap.depth_mm);
  }
  if (!words.empty()) return words;
  if (!done.result.converged) return "the search ended before it converged";
  return done.observer.target().count() > 1
             ? "no limit is active: the free movements cannot reach it, or not together with the "
               "other targets"
             : "no limit is active: the free movements cannot give the face this shape";
}

Json bodies_json(const Optimization& done) {
  const std::vector<inverse::MotionVector> motions = done.variables.motions(done.result.face.x);
  Json bodies = Json::array();
  for (std::size_t b = 0; b < motions.size(); ++b) {
    const inverse::RigidBody& body = done.variables.bodies()[b];
    Json json{{"name", body.name}, {"segments", Json::array()}};
    for (const std::size_t k : body.segments)
      json["segments"].push_back(done.prepared.plan.segments[k].osteotomy.segment);
    json["center_mm"] = as_json(body.center_L);
    Json& numbers = json["numbers"] = Json::array();
    for (std::size_t i = 0; i < 6; ++i) {
      const auto row = Index(i);
      const double value = motions[b][row];
      numbers.push_back({{"name", inverse::kMotionNames[i]},
                         {"unit", i < 3 ? "mm" : "deg"},
                         {"value", value},
                         {"start", body.start[row]},
                         {"free", body.is_free[i] && body.lower[row] < body.upper[row]},
                         {"lower", body.lower[row]},
                         {"upper", body.upper[row]}});
    }
    bodies.push_back(std::move(json));
  }
  return bodies;
}

Json history_json(const inverse::MotionResult& result) {
  Json history = Json::array();
  std::size_t search = 0;
  for (std::size_t n = 0; n < result.history.size(); ++n) {
    while (search < result.starts.size() && result.starts[search] <= n) ++search;
    const inverse::LeastSquaresIterate& one = result.history[n];
    history.push_back({{"search", search},
                       {"objective_mm2", one.objective},
                       {"projected_gradient", one.projected_gradient},
                       {"step", one.step},
                       {"damping", one.damping},
                       {"accepted", one.is_accepted},
                       {"x", as_list(one.x)}});
  }
  return history;
}

}  // namespace

std::string describe(const inverse::MotionDirection& direction,
                     const inverse::MotionVariables& variables) {
  constexpr double kShown = 0.1;
  std::string words;
  for (Index n = 0; n < variables.count(); ++n)
    if (std::abs(direction.direction[n]) >= kShown)
      words += fmt::format("{}{} {:.2f} {}", words.empty() ? "" : ", ", variables.name(n),
                           direction.direction[n], variables.unit(n));
  return words;
}

std::vector<TargetResult> target_results(const Optimization& done) {
  const std::size_t count = done.observer.target().count();
  const std::vector<Vec3> rest(done.certified_mm.size(), Vec3::Zero());
  const auto before = inverse::residuals_by_target(done.observer.observe(rest), count);
  const auto reached = inverse::residuals_by_target(done.certified, count);
  std::vector<TargetResult> results;
  for (std::size_t k = 0; k < count; ++k) {
    TargetResult& one = results.emplace_back(
        TargetResult{done.observer.target().name(k), before[k], reached[k], false, {}});
    const bool counts = done.observer.target().weight(k) > 0.0;
    one.is_reached = counts && reached[k].rms_mm <= kReached_mm;
    if (!one.is_reached)
      one.reason = counts ? reason_of(done, k) : "its weight is 0: it was not a target";
  }
  return results;
}

Json optimize_json(const Optimization& done) {
  const inverse::MotionResult& result = done.result;
  Json json{{"lefort_optimize", 1},
            {"notice", kNotForClinicalUse},
            {"version", kVersion},
            {"title", done.spec.title},
            {"inputs",
             {{"plan_sha256", done.prepared.provenance.plan_sha256},
              {"ct_sha256", done.prepared.provenance.ct_sha256},
              {"target_sha256", done.target_sha256}}},
            {"converged", result.converged},
            {"objective_mm2",
             {{"before_surgery", done.start_objective},
              {"optimized", result.face.target_objective},
              {"certified", inverse::objective_mm2(done.certified)}}},
            {"bodies", bodies_json(done)}};
  Json& variables = json["variables"] = Json::array();
  for (Index n = 0; n < done.variables.count(); ++n) {
    const auto i = std::size_t(n);
    variables.push_back({{"name", done.variables.name(n)},
                         {"unit", done.variables.unit(n)},
                         {"value", result.face.x[n]},
                         {"at_bound", result.at_lower[i] != 0   ? Json("lower")
                                      : result.at_upper[i] != 0 ? Json("upper")
                                                                : Json(nullptr)}});
  }
  Json& targets = json["targets"] = Json::array();
  for (const TargetResult& one : target_results(done))
    targets.push_back({{"name", one.name},
                       {"before_surgery", residual_json(one.before)},
                       {"certified", residual_json(one.reached)},
                       {"reached", one.is_reached},
                       {"reason", one.is_reached ? Json(nullptr) : Json(one.reason)}});
  json["overlap"] = {{"allowed_mm", done.allowed_overlap_mm},
                     {"deepest_mm", result.overlap.depth_mm},
                     {"depth_is_lower_bound", result.overlap.is_lower_bound},
                     {"limits", result.is_limited_by_overlap}};
  json["gradient_check"] =
      result.gradient_error ? Json{{"relative_difference", *result.gradient_error}} : Json(nullptr);
  Json& directions = json["directions"] = Json::array();
  for (const inverse::MotionDirection& one : result.directions)
    directions.push_back({{"direction", as_list(one.direction)},
                          {"face_mm_per_unit", one.face_mm},
                          {"determined", one.is_determined},
                          {"description", describe(one, done.variables)}});
  json["coarse_element_size_mm"] = done.coarse_element_size_mm;
  Json& corrections = json["corrections"] = Json::array();
  for (const inverse::Correction& one : result.corrections)
    corrections.push_back({{"x", as_list(one.x)},
                           {"coarse_objective_mm2", one.coarse_objective},
                           {"fine_objective_mm2", one.fine_objective},
                           {"step", one.step}});
  json["history"] = history_json(result);
  return json;
}

}  // namespace lefort::pipeline
