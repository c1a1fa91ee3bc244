#include <lefort/core/version.h>
#include <lefort/geometry/mesh_properties.h>
#include <lefort/pipeline/optimize/optimization_report.h>
#include <lefort/predict/embed_skin.h>
#include <lefort/report/annotate.h>
#include <lefort/report/picture.h>
#include <lefort/report/render_surfaces.h>
#include <lefort/report/view.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace lefort::pipeline {
namespace {

/// Rounded for "{:.2f}", which would print a small negative number as -0.00.
double to_hundredths(double value) { return std::round(100.0 * value) / 100.0 + 0.0; }

constexpr report::PictureSize kDrawnSize{.width = 1000, .height = 900, .supersampling = 2};
constexpr report::Rgb kWanted{0.80, 0.15, 0.15}, kReached{0.10, 0.45, 0.75};
constexpr double kMarker_mm = 1.6;

/// An octahedron at each point.
geometry::TriangleMesh markers(const std::vector<Vec3>& points_L) {
  geometry::TriangleMesh mesh;
  for (const Vec3& p : points_L) {
    const auto first = std::int32_t(mesh.vertices.size());
    for (const double side : {1.0, -1.0})
      for (Index axis = 0; axis < 3; ++axis)
        mesh.vertices.push_back(p + side * kMarker_mm * Vec3::Unit(axis));
    for (const std::array<std::int32_t, 3>& t : {std::array{0, 1, 2},
                                                 {1, 3, 2},
                                                 {3, 4, 2},
                                                 {4, 0, 2},
                                                 {1, 0, 5},
                                                 {3, 1, 5},
                                                 {4, 3, 5},
                                                 {0, 4, 5}})
      mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  return mesh;
}

/// Points of landmarks: reached, and wanted.
struct LandmarkPoints {
  std::vector<Vec3> reached_L, wanted_L;
};

LandmarkPoints landmark_points(const Optimization& done) {
  LandmarkPoints points;
  const auto& landmarks = done.observer.target().landmarks;
  for (std::size_t i = 0; i < done.certified.size();
       i += std::size_t(done.certified[i].components)) {
    const inverse::Observation& one = done.certified[i];
    if (one.target >= landmarks.size()) break;
    const inverse::LandmarkTarget& of = landmarks[one.target];
    points.reached_L.push_back(one.at_L);
    points.wanted_L.push_back(of.direction_L ? Vec3(one.at_L - one.residual_mm * *of.direction_L)
                                             : of.to_L);
  }
  return points;
}

/// Distance of the certified skin from the first surface; NaN where none was measured.
std::vector<double> surface_distances(const Optimization& done) {
  std::vector<double> distances(done.certified_mm.size(), std::numeric_limits<double>::quiet_NaN());
  const inverse::FaceTarget& target = done.observer.target();
  const std::size_t first = target.landmarks.size() + target.profiles.size();
  for (const inverse::Observation& one : done.certified)
    if (one.target == first) distances[std::size_t(one.vertices[0])] = one.residual_mm;
  return distances;
}

/// Profiles before and after, and the wanted points. Anterior is to the right.
report::LinePlot profile_plot(const Optimization& done, const inverse::ProfileTarget& of,
                              const Box3& skin_L) {
  constexpr double kStep_mm = 0.5, kMargin_mm = 25.0;
  double low = of.points.front().z_mm, high = low;
  for (const inverse::ProfilePoint& point : of.points) {
    low = std::min(low, point.z_mm);
    high = std::max(high, point.z_mm);
  }
  low = std::max(low - kMargin_mm, skin_L.min().z());
  high = std::min(high + kMargin_mm, skin_L.max().z());
  std::vector<double> z_mm;
  for (double z = low; z <= high; z += kStep_mm) z_mm.push_back(z);
  report::LinePlot plot{.title = fmt::format("{}, plane x = {:.1f} mm", of.name, of.x_mm),
                        .x_label = "anterior [mm]",
                        .y_label = "height z [mm]"};
  const auto add = [&](const char* name, const std::vector<Vec3>& displacement_mm) {
    report::PlotLine line{.name = name};
    const auto y_mm = done.observer.profile_y_mm(displacement_mm, of.x_mm, z_mm);
    for (std::size_t n = 0; n < z_mm.size(); ++n) {
      line.x.push_back(y_mm[n] ? -*y_mm[n] : std::numeric_limits<double>::quiet_NaN());
      line.y.push_back(z_mm[n]);
    }
    plot.lines.push_back(std::move(line));
  };
  add("before surgery", std::vector<Vec3>(done.certified_mm.size(), Vec3::Zero()));
  add("predicted", done.certified_mm);
  report::PlotLine wanted{.name = "target", .points_only = true};
  for (const inverse::ProfilePoint& point : of.points) {
    wanted.x.push_back(-point.y_mm);
    wanted.y.push_back(point.z_mm);
  }
  plot.lines.push_back(std::move(wanted));
  return plot;
}

report::LinePlot history_plot(const inverse::MotionResult& result) {
  report::LinePlot plot{.title = "Objective",
                        .x_label = "trial point of the coarse model",
                        .y_label = "objective [mm\u00b2]",
                        .y_axis = report::Axis::kLog};
  report::PlotLine coarse{.name = "coarse model, corrected"},
      fine{.name = "model of the plan", .points_only = true};
  for (std::size_t n = 0; n < result.history.size(); ++n) {
    if (!result.history[n].is_accepted) continue;
    coarse.x.push_back(double(n));
    coarse.y.push_back(result.history[n].objective);
  }
  for (std::size_t n = 0; n < result.corrections.size(); ++n) {
    const std::size_t at =
        n + 1 < result.starts.size() ? result.starts[n + 1] : result.history.size();
    fine.x.push_back(double(at));
    fine.y.push_back(result.corrections[n].fine_objective);
  }
  for (std::size_t n = 1; n < result.starts.size(); ++n)
    plot.dividers_x.push_back(double(result.starts[n]));
  plot.lines = {std::move(coarse), std::move(fine)};
  return plot;
}

report::ReportTable target_table(const Optimization& done) {
  report::ReportTable table{"Targets",
                            {"target", "before surgery, RMS [mm]", "predicted, RMS [mm]",
                             "largest [mm]", "reached", "reason"},
                            {}};
  for (const TargetResult& one : target_results(done))
    table.rows.push_back({one.name, fmt::format("{:.2f}", one.before.rms_mm),
                          fmt::format("{:.2f}", one.reached.rms_mm),
                          fmt::format("{:.2f}", one.reached.max_mm), one.is_reached ? "yes" : "no",
                          one.reason});
  return table;
}

report::ReportTable movement_table(const Optimization& done) {
  report::ReportTable table{
      "Movements", {"number", "given plan", "optimized", "lowest", "highest", "limit"}, {}};
  const std::vector<inverse::MotionVector> motions = done.variables.motions(done.result.face.x);
  for (std::size_t b = 0; b < motions.size(); ++b)
    for (std::size_t i = 0; i < 6; ++i) {
      const inverse::RigidBody& body = done.variables.bodies()[b];
      const auto row = Index(i);
      const std::string name =
          fmt::format("{} {} [{}]", body.name, inverse::kMotionNames[i], i < 3 ? "mm" : "\u00b0");
      const bool is_free = body.is_free[i] && body.lower[row] < body.upper[row];
      const double value = motions[b][row];
      table.rows.push_back({name, fmt::format("{:.2f}", to_hundredths(body.start[row])),
                            fmt::format("{:.2f}", to_hundredths(value)),
                            is_free ? fmt::format("{:g}", body.lower[row]) : "\u2013",
                            is_free ? fmt::format("{:g}", body.upper[row]) : "\u2013",
                            !is_free                   ? "not free"
                            : value <= body.lower[row] ? "at the lower bound"
                            : value >= body.upper[row] ? "at the upper bound"
                                                       : ""});
    }
  return table;
}

report::ReportTable direction_table(const Optimization& done) {
  report::ReportTable table{
      "What the target determines",
      {"movement", "change of the targets by 1 mm or 1\u00b0 [mm]", "determined"},
      {}};
  for (const inverse::MotionDirection& one : done.result.directions)
    table.rows.push_back({describe(one, done.variables), fmt::format("{:.3f}", one.face_mm),
                          one.is_determined ? "yes" : "no"});
  return table;
}

/// Pairs pictures from the same camera, and adds the others singly.
void add_pictures(const std::vector<OptimizationPicture>& pictures, report::CaseReport& report) {
  const auto find = [&](const std::string& file) -> const OptimizationPicture* {
    for (const OptimizationPicture& one : pictures)
      if (one.file == file) return &one;
    return nullptr;
  };
  for (const char* name : {"front", "right_profile"}) {
    const OptimizationPicture* before = find(fmt::format("before_{}.png", name));
    const OptimizationPicture* after = find(fmt::format("predicted_{}.png", name));
    if (before != nullptr && after != nullptr)
      report.comparisons.push_back(
          {after->title, "Same camera; drag to compare.", before->png, after->png});
    if (const OptimizationPicture* distance = find(fmt::format("distance_{}.png", name)))
      report.pictures.push_back({distance->title, "Positive: outside the target.", distance->png});
  }
}

std::string movement_sentence(const Optimization& done) {
  std::string words;
  const std::vector<inverse::MotionVector> motions = done.variables.motions(done.result.face.x);
  for (std::size_t b = 0; b < motions.size(); ++b) {
    const inverse::MotionVector m = motions[b].unaryExpr(&to_hundredths);
    words += fmt::format(
        "{}\u201c{}\u201d moves {:.2f} mm forward, {:.2f} mm up and {:.2f} mm to the left, and "
        "rotates by {:.2f}\u00b0 (pitch), {:.2f}\u00b0 (roll), {:.2f}\u00b0 (yaw)",
        words.empty() ? "" : "; ", done.variables.bodies()[b].name, m[1], m[2], m[0], m[3], m[4],
        m[5]);
  }
  return words + ".";
}

}  // namespace

Result<std::vector<OptimizationPicture>> draw_optimization(const Optimization& done,
                                                           Progress& progress) {
  using report::StandardView;
  using report::SurfaceScene;
  const geometry::TriangleMesh& before_L = done.prepared.skin_L;
  const geometry::TriangleMesh after_L = predict::displaced(before_L, done.certified_mm);
  const LandmarkPoints points = landmark_points(done);
  const geometry::TriangleMesh reached_L = markers(points.reached_L),
                               wanted_L = markers(points.wanted_L);
  Box3 focus_L = geometry::bounding_box(before_L);
  focus_L.extend(geometry::bounding_box(after_L));
  std::vector<OptimizationPicture> pictures;
  const auto draw = [&](const SurfaceScene& scene, StandardView side, const std::string& file,
                        const std::string& title,
                        const std::optional<report::ColorBar>& bar) -> Result<void> {
    const report::View view =
        report::standard_view(side, focus_L, double(kDrawnSize.width) / kDrawnSize.height);
    LEFORT_TRY(const report::Picture raw, scene.render(view, kDrawnSize, progress));
    LEFORT_TRY(const report::Picture shown, report::annotate(raw, {title, bar, view}));
    LEFORT_TRY(std::string png, report::encode_png(shown));
    pictures.push_back({file, title, std::move(png)});
    return {};
  };
  const std::array<report::SurfaceLayer, 1> face_before{{{.mesh_L = &before_L}}};
  const std::array<report::SurfaceLayer, 3> face_after{{{.mesh_L = &after_L},
                                                        {.mesh_L = &reached_L, .color = kReached},
                                                        {.mesh_L = &wanted_L, .color = kWanted}}};
  LEFORT_TRY(const SurfaceScene before, SurfaceScene::build(face_before, progress));
  LEFORT_TRY(const SurfaceScene after, SurfaceScene::build(face_after, progress));
  for (const auto& [side, name] : {std::pair{StandardView::kFront, "front"},
                                   std::pair{StandardView::kRightProfile, "right_profile"}}) {
    const std::string view = report::name_of(side);
    LEFORT_TRY_VOID(draw(before, side, fmt::format("before_{}.png", name), "Before, " + view, {}));
    LEFORT_TRY_VOID(draw(after, side, fmt::format("predicted_{}.png", name),
                         points.wanted_L.empty() ? "Predicted, " + view
                                                 : "Predicted (blue) and target (red), " + view,
                         {}));
  }
  if (done.observer.target().surfaces.empty()) return pictures;
  const report::ColorScale scale{report::ColorMap::kDiverging, -2.0, 2.0};
  LEFORT_TRY(const SurfaceScene distance, after.recolored(0, surface_distances(done), scale));
  for (const auto& [side, name] : {std::pair{StandardView::kFront, "front"},
                                   std::pair{StandardView::kRightProfile, "right_profile"}})
    LEFORT_TRY_VOID(draw(distance, side, fmt::format("distance_{}.png", name),
                         std::string("Distance from the target, ") + report::name_of(side),
                         report::ColorBar{scale, "distance", "mm"}));
  return pictures;
}

report::CaseReport optimization_report(const Optimization& done,
                                       const std::vector<OptimizationPicture>& pictures) {
  const inverse::MotionResult& result = done.result;
  report::CaseReport report;
  report.title = done.spec.title.empty() ? "Optimized plan" : done.spec.title;
  report.subtitle = "Bone movements computed from a target face";
  report.plan = movement_sentence(done);
  report.converged = result.converged;
  if (!result.converged) report.failure = "the search ended before it converged";
  add_pictures(pictures, report);
  std::size_t reached = 0;
  const std::vector<TargetResult> targets = target_results(done);
  for (const TargetResult& one : targets) reached += one.is_reached ? 1U : 0U;
  report.key_numbers = {
      {"targets reached", fmt::format("{} of {}", reached, targets.size())},
      {"objective before and after", fmt::format("{:.3f} and {:.3f} mm\u00b2", done.start_objective,
                                                 inverse::objective_mm2(done.certified))},
      {"deepest bone overlap",
       fmt::format("{}{:.2f} of {:g} mm", result.overlap.is_lower_bound ? "more than " : "",
                   result.overlap.depth_mm, done.allowed_overlap_mm)}};
  report.tables = {target_table(done), movement_table(done), direction_table(done)};
  const Box3 skin_L = geometry::bounding_box(done.prepared.skin_L);
  for (const inverse::ProfileTarget& profile : done.observer.target().profiles)
    report.plots.push_back(profile_plot(done, profile, skin_L));
  report.plots.push_back(history_plot(result));
  report.plots_heading = "Profile and search";
  if (!result.converged)
    report.notes.push_back(
        "The search ended before it converged: the movements may still be "
        "improved.");
  for (const inverse::MotionDirection& one : result.directions)
    if (!one.is_determined)
      report.notes.push_back(
          "The target does not determine this movement, which stays near the "
          "given plan: " +
          describe(one, done.variables));
  if (result.gradient_error)
    report.notes.push_back(
        fmt::format("Gradient check: largest relative difference from central "
                    "differences {:.1e}.",
                    *result.gradient_error));
  report.provenance = {{"sha256 of the plan", done.prepared.provenance.plan_sha256},
                       {"sha256 of the CT", done.prepared.provenance.ct_sha256},
                       {"sha256 of the target", done.target_sha256},
                       {"version", kVersion}};
  report.limitations = {
      "The movements are those whose predicted face is closest to the target in this model. Where "
      "the prediction errs, the movements err too.",
      "A movement that is feasible here need not be feasible in surgery: occlusion, airway, blood "
      "supply, fixation and stability are not part of the objective."};
  return report;
}

}  // namespace lefort::pipeline
