#include <lefort/core/units.h>
#include <lefort/core/version.h>
#include <lefort/geometry/rigid_path.h>
#include <lefort/pipeline/predict/prediction_report.h>
#include <lefort/pipeline/predict/write_prediction.h>
#include <lefort/predict/assign_regions.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

namespace lefort::pipeline {
namespace {

/// "6.0 mm forward, 5.0 mm down" from a translation in L.
std::string in_words(const Vec3& translation_mm) {
  struct Direction {
    Vec3 axis_L;
    const char* positive;
    const char* negative;
  };
  const std::array<Direction, 3> directions{{{-Vec3::UnitY(), "forward", "backward"},
                                             {Vec3::UnitZ(), "up", "down"},
                                             {Vec3::UnitX(), "to the left", "to the right"}}};
  std::string words;
  for (const Direction& direction : directions) {
    const double mm = translation_mm.dot(direction.axis_L);
    if (std::abs(mm) < 0.05) continue;
    if (!words.empty()) words += ", ";
    words += fmt::format("{:.1f} mm {}", std::abs(mm),
                         mm > 0.0 ? direction.positive : direction.negative);
  }
  return words.empty() ? "no translation" : words;
}

/// "Segment “maxilla” moves 6.0 mm forward"
std::string move_in_words(const geometry::RigidPath& path) {
  const geometry::Keyframe& end = path.keyframes.back();
  std::string words =
      fmt::format("Segment \u201c{}\u201d moves {}", path.segment, in_words(end.translation_mm));
  const double angle_deg = degrees_from_radians(end.rotation_rad.norm());
  if (angle_deg > 0.05)
    words += fmt::format(
        " and turns by {:.1f}\u00b0 about the point that lay at ({:.1f}, {:.1f}, {:.1f}) mm",
        angle_deg, end.center_L.x(), end.center_L.y(), end.center_L.z());
  return words;
}

std::string plan_sentence(const PreparedCase& prepared) {
  std::string sentence;
  for (const geometry::RigidPath& path : prepared.paths())
    sentence += (sentence.empty() ? "" : "; ") + move_in_words(path);
  return sentence + fmt::format(", in {} steps.", prepared.steps());
}

report::ReportTable step_table(const predict::FacePrediction& prediction) {
  report::ReportTable table{
      "Steps along the path",
      {"path done [%]", "Newton iterations", "relative residual", "nodes in contact",
       "max penetration [mm]", "mean penetration [mm]", "max depth from rest [mm]", "its P99 [mm]",
       "contact force [N]", "smallest volume ratio"},
      {}};
  for (const predict::PredictionStep& step : prediction.steps) {
    const contact::ContactStatistics contact = step.contact();
    table.rows.push_back(
        {fmt::format("{:.1f}", 100.0 * step.path_fraction),
         fmt::format("{}", step.newton_iterations()), fmt::format("{:.1e}", step.relative_residual),
         fmt::format("{}", contact.nodes), fmt::format("{:.3f}", contact.max_penetration_mm),
         fmt::format("{:.3f}", contact.mean_penetration_mm),
         fmt::format("{:.3f}", contact.max_depth_from_rest_mm),
         fmt::format("{:.3f}", contact.p99_depth_from_rest_mm),
         fmt::format("{:.3f}", contact.force_L_n.norm()), fmt::format("{:.3f}", step.min_J)});
  }
  return table;
}

/// Of a plan of several segments: each after the last step.
report::ReportTable segment_table(const PreparedCase& prepared,
                                  const predict::PredictionStep& last) {
  report::ReportTable table{
      "Segments at the end of the path",
      {"segment", "volume [ml]", "nodes in contact", "contact area [mm\u00b2]",
       "max depth from rest [mm]", "its P99 [mm]", "contact force [N]"},
      {}};
  for (std::size_t k = 0; k < last.segments.size(); ++k) {
    const contact::ContactStatistics& contact = last.segments[k].contact;
    table.rows.push_back({prepared.plan.segments[k].osteotomy.segment,
                          fmt::format("{:.1f}", prepared.cut.volumes_mm3[k] * 1e-3),
                          fmt::format("{}", contact.nodes), fmt::format("{:.0f}", contact.area_mm2),
                          fmt::format("{:.3f}", contact.max_depth_from_rest_mm),
                          fmt::format("{:.3f}", contact.p99_depth_from_rest_mm),
                          fmt::format("{:.3f}", contact.force_L_n.norm())});
  }
  return table;
}

/// "79719 tet4, 352 pyramid5, 7718 wedge6"
std::string shapes_in_words(const mesh::MeshQuality& quality) {
  std::string words;
  for (const auto& [shape, summary] : quality.by_shape)
    words +=
        fmt::format("{}{} {}", words.empty() ? "" : ", ", summary.elements, mesh::name_of(shape));
  return words;
}

std::string law_in_words(double young_mpa, double poisson) {
  return fmt::format("E {:.1f} kPa, \u03bd {:.3f}", kpa_from_mpa(young_mpa), poisson);
}

std::string mucosa_in_words(const predict::TissueOptions& tissue) {
  if (!tissue.mucosa) return "as what is inside";
  return fmt::format("within {:g} mm of the air inside; {}", tissue.mucosa->thickness_mm,
                     law_in_words(tissue.mucosa->young_mpa, tissue.mucosa->poisson));
}

std::string muscle_in_words(const predict::TissueOptions& tissue) {
  if (!tissue.muscle) return "as what is inside";
  return "as labelled; " + law_in_words(tissue.muscle->young_mpa, tissue.muscle->poisson);
}

/// What the tissue is taken for, and what of it is not told apart.
std::string material_limits(const predict::TissueOptions& tissue) {
  if (!tissue.skin && !tissue.mucosa && !tissue.muscle)
    return "Soft tissue is one homogeneous, compressible, elastic material at rest without "
           "pre-stress; skin, fat and muscle are not told apart.";
  std::string text = "What lies inside";
  if (tissue.skin) text += ", skin";
  if (tissue.mucosa) text += ", mucosa";
  if (tissue.muscle) text += ", muscle";
  text += " are each one homogeneous, compressible, elastic material at rest without pre-stress; ";
  if (tissue.muscle) text += "muscle has no fibres and does not contract; ";
  if (tissue.skin) text += "skin is no thinner at the lids; ";
  text += "fat";
  if (!tissue.skin) text += ", skin";
  if (!tissue.muscle) text += ", muscle";
  return text + " and the rest are not told apart.";
}

std::string skin_in_words(const PreparedCase& prepared) {
  const auto& skin = prepared.plan.tissue.skin;
  if (!skin || !prepared.skin_layer) return "as what is inside";
  return fmt::format("{} layers, {:g} mm asked for, {:.2f} mm on average under {:.0f} % of it; {}",
                     skin->layers, skin->thickness_mm, prepared.skin_layer->mean_mm,
                     100.0 * prepared.skin_layer->covered_fraction,
                     law_in_words(skin->young_mpa, skin->poisson));
}

report::ReportTable parameter_table(const PreparedCase& prepared,
                                    const predict::FacePrediction& prediction) {
  const io::PlanFile& plan = prepared.plan;
  const bool is_contact = plan.boundary.segment_interface == predict::SegmentInterface::kSliding;
  double segments_mm3 = 0.0, fragments_mm3 = 0.0, cell_mm = 0.0;
  double band_mm = std::numeric_limits<double>::infinity();
  Index fragments = 0;
  for (std::size_t k = 0; k < plan.segments.size(); ++k) {
    segments_mm3 += prepared.cut.volumes_mm3[k];
    fragments_mm3 += prepared.cut.cuts[k].fragment_volume_mm3;
    fragments += prepared.cut.cuts[k].fragments;
    cell_mm = std::max(cell_mm, prepared.model.segments[k].field_B->cell_mm());
    band_mm = std::min(band_mm, prepared.model.segments[k].field_B->band_mm());
  }
  return {
      "Model",
      {"quantity", "value"},
      {{"elements", shapes_in_words(prepared.quality)},
       {"nodes", fmt::format("{}", prepared.model.tissue.node_count())},
       {"smallest dihedral angle", fmt::format("{:.1f}\u00b0", prepared.quality.min_dihedral_deg)},
       {"smallest scaled Jacobian", fmt::format("{:.3f}", prepared.quality.min_scaled_jacobian)},
       {"soft tissue law", "compressible neo-Hookean"},
       {"Young\u2019s modulus", fmt::format("{:.1f} kPa", kpa_from_mpa(plan.tissue.young_mpa))},
       {"Poisson\u2019s ratio", fmt::format("{:.3f}", plan.tissue.poisson)},
       {"skin", skin_in_words(prepared)},
       {"mucosa", mucosa_in_words(plan.tissue)},
       {"muscle", muscle_in_words(plan.tissue)},
       {"regions", predict::describe_regions(prepared.model.tissue, plan.tissue)},
       {"tissue on the moved bone",
        is_contact ? "slides without friction (contact)" : "moves with the bone (attached)"},
       {"contact stiffness k_c", is_contact
                                     ? fmt::format("{:.4f} MPa/mm = {:g} \u00d7 E / element size",
                                                   prediction.contact_stiffness_mpa_per_mm,
                                                   predict::stiffness_factor(plan.contact))
                                     : std::string("\u2013")},
       {"penetration of the mesh at rest",
        is_contact ? fmt::format("up to {:.2f} mm", prediction.rest_penetration_mm)
                   : std::string("\u2013")},
       {"tissue elevated from still bone",
        fmt::format("within {:.1f} mm of the segment", plan.boundary.elevation_margin_mm)},
       {"distance field of the segment",
        fmt::format("cell {:.3f} mm, band {:.2f} mm", cell_mm, band_mm)},
       {"segment volume", fmt::format("{:.1f} ml", segments_mm3 * 1e-3)},
       {"bone inside the planes that does not move",
        fmt::format("{:.2f} ml in {} pieces", fragments_mm3 * 1e-3, fragments)}}};
}

report::ReportTable timing_table(const Timing& timing) {
  report::ReportTable table{"Time", {"stage", "seconds"}, {}};
  for (const auto& [name, seconds] : timing.stage_seconds)
    table.rows.push_back({name, fmt::format("{:.1f}", seconds)});
  return table;
}

std::vector<report::SolverStep> solver_steps(const predict::FacePrediction& prediction) {
  std::vector<report::SolverStep> steps;
  for (const predict::PredictionStep& step : prediction.steps) {
    report::SolverStep& shown = steps.emplace_back();
    shown.path_fraction = step.path_fraction;
    const contact::ContactStatistics contact = step.contact();
    shown.max_penetration_mm = contact.max_penetration_mm;
    shown.mean_penetration_mm = contact.mean_penetration_mm;
    for (const fem::LoadAttempt& attempt : step.attempts)
      for (const fem::NewtonIterate& iterate : attempt.history)
        if (iterate.residual_reference_n > 0.0)
          shown.relative_residuals.push_back(iterate.residual_n / iterate.residual_reference_n);
  }
  return steps;
}

/// Pairs pictures of the same side, shows the others one by one.
void add_pictures(std::span<const PredictionPicture> pictures, report::CaseReport& report) {
  std::vector<const PredictionPicture*> before;
  for (const PredictionPicture& picture : pictures)
    if (picture.kind == PictureKind::kBefore) before.push_back(&picture);
  std::size_t pairs = 0;
  for (const PredictionPicture& picture : pictures) {
    if (picture.kind == PictureKind::kBefore) continue;
    if (picture.kind == PictureKind::kAfter && pairs < before.size()) {
      report.comparisons.push_back(
          {"Before and predicted" + picture.title.substr(picture.title.find(',')),
           "Same camera; drag to compare.", before[pairs]->png, picture.png});
      ++pairs;
    } else {
      report.pictures.push_back({picture.title, "", picture.png});
    }
  }
}

}  // namespace

report::CaseReport prediction_report(const PreparedCase& prepared,
                                     const predict::FacePrediction& prediction,
                                     std::span<const PredictionPicture> pictures,
                                     const SkinShift& skin, const Timing& timing) {
  report::CaseReport report;
  report.title = prepared.plan.title.empty() ? "Predicted face" : prepared.plan.title;
  report.subtitle = "Simulated soft-tissue response to a planned bone movement";
  report.plan = plan_sentence(prepared);
  report.converged = prediction.converged();
  if (prediction.failure) report.failure = prediction.failure->message;
  add_pictures(pictures, report);
  if (!prediction.steps.empty()) {
    const predict::PredictionStep& last = prediction.steps.back();
    report.key_numbers = {
        {"largest shift of the skin", fmt::format("{:.1f} mm", skin.max_mm)},
        {"mean shift where the skin moved over 0.5 mm",
         fmt::format("{:.1f} mm", skin.mean_over_moved_mm)},
        {"largest remaining penetration",
         fmt::format("{:.2f} mm", last.contact().max_penetration_mm)},
        {"steps converged", fmt::format("{} of {}", prediction.steps.size(), prepared.steps())}};
  }
  report.tables = {step_table(prediction), parameter_table(prepared, prediction),
                   timing_table(timing)};
  if (prepared.plan.segments.size() > 1 && !prediction.steps.empty())
    report.tables.insert(report.tables.begin(), segment_table(prepared, prediction.steps.back()));
  report.steps = solver_steps(prediction);
  report.residual_tolerance = prepared.plan.solver.relative_tolerance;
  report.notes = prepared.provenance.warnings;
  const auto deepest = std::max_element(
      prepared.overlaps.begin(), prepared.overlaps.end(),
      [](const predict::BoneOverlapAtFraction& a, const predict::BoneOverlapAtFraction& b) {
        return a.overlap.deepest_mm < b.overlap.deepest_mm;
      });
  if (deepest != prepared.overlaps.end() && deepest->overlap.overlaps())
    report.notes.push_back(describe(*deepest, prepared.plan) +
                           fmt::format("; depths of all steps are in prediction.json and, of each "
                                       "segment, in {}*.vtp.",
                                       kBoneOverlap));
  if (!prediction.steps.empty())
    if (const contact::ContactStatistics contact = prediction.steps.back().contact();
        contact.tunnelled_area_mm2 > 0.0)
      report.notes.push_back(
          fmt::format("Contact is as soft as its stiffness: {:.1f} mm\u00b2 of tissue, of {:.0f} "
                      "mm\u00b2 in contact, crept through thin bone.",
                      contact.tunnelled_area_mm2, contact.area_mm2));
  report.provenance = {{"lefort version", kVersion},
                       {"SHA-256 of the plan", prepared.provenance.plan_sha256},
                       {"SHA-256 of the scan\u2019s voxels", prepared.provenance.ct_sha256},
                       {"kind of scan", prepared.provenance.ct_kind},
                       {"SHA-256 of the labels", prepared.provenance.labels_sha256},
                       {"labels", prepared.provenance.labels_source}};
  for (const auto& [name, sha256] : prepared.provenance.plan_files)
    report.provenance.push_back({"SHA-256 of " + name, sha256});
  report.limitations = {
      material_limits(prepared.plan.tissue),
      "Linear tetrahedra are too stiff for nearly incompressible tissue; Poisson\u2019s ratio is "
      "chosen lower than measured for that reason.",
      "Tissue outside the meshed region does not move, and where the scan ends tissue has no "
      "neighbour: near the scan\u2019s edge the prediction is not to be trusted.",
      prepared.model.stationary_bone
          ? "Air-filled sinuses are taken as part of the bone. Still bone holds the tissue on it, "
            "but not what is painted free or to slide; only what slides meets still bone."
          : "Air-filled sinuses are taken as part of the bone. Still bone holds the tissue on it; "
            "tissue does not meet still bone anew.",
      "Not validated against post-operative scans."};
  return report;
}

}  // namespace lefort::pipeline
