#include <lefort/core/units.h>
#include <lefort/core/version.h>
#include <lefort/geometry/rigid_path.h>
#include <lefort/pipeline/predict/prediction_report.h>
#include <lefort/pipeline/predict/write_prediction.h>
#include <lefort/predict/assign_regions.h>
#include <lefort/predict/path_overlaps.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

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
  return words.empty() ? "0.0 mm" : words;
}

/// "Segment “maxilla” moves 6.0 mm forward"
std::string move_in_words(const geometry::RigidPath& path) {
  const geometry::Keyframe& end = path.keyframes.back();
  std::string words =
      fmt::format("Segment \u201c{}\u201d moves {}", path.segment, in_words(end.translation_mm));
  const double angle_deg = degrees_from_radians(end.rotation_rad.norm());
  if (angle_deg > 0.05)
    words += fmt::format(
        " and rotates by {:.1f}\u00b0 about the point initially at ({:.1f}, {:.1f}, {:.1f}) mm",
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
      {"path fraction [%]", "Newton iterations", "relative residual", "nodes in contact",
       "max penetration [mm]", "mean penetration [mm]", "max penetration increase [mm]",
       "P99 penetration increase [mm]", "contact force [N]", "min Jacobian"},
      {}};
  for (const predict::PredictionStep& step : prediction.steps) {
    const contact::ContactStatistics contact = step.contact();
    table.rows.push_back(
        {fmt::format("{:.1f}", 100.0 * step.path_fraction),
         fmt::format("{}", step.newton_iterations()), fmt::format("{:.1e}", step.relative_residual),
         fmt::format("{}", contact.nodes), fmt::format("{:.3f}", contact.max_penetration_mm),
         fmt::format("{:.3f}", contact.mean_penetration_mm),
         fmt::format("{:.3f}", contact.max_penetration_increase_mm),
         fmt::format("{:.3f}", contact.p99_penetration_increase_mm),
         fmt::format("{:.3f}", contact.force_L_n.norm()), fmt::format("{:.3f}", step.min_J)});
  }
  return table;
}

/// For a plan of several segments: each segment after the last step.
report::ReportTable segment_table(const PreparedCase& prepared,
                                  const predict::PredictionStep& last) {
  report::ReportTable table{
      "Segments at the end of the path",
      {"segment", "volume [ml]", "nodes in contact", "contact area [mm\u00b2]",
       "max penetration increase [mm]", "P99 penetration increase [mm]", "contact force [N]"},
      {}};
  for (std::size_t k = 0; k < last.segments.size(); ++k) {
    const contact::ContactStatistics& contact = last.segments[k].contact;
    table.rows.push_back({prepared.plan.segments[k].osteotomy.segment,
                          fmt::format("{:.1f}", prepared.cut.volumes_mm3[k] * 1e-3),
                          fmt::format("{}", contact.nodes), fmt::format("{:.0f}", contact.area_mm2),
                          fmt::format("{:.3f}", contact.max_penetration_increase_mm),
                          fmt::format("{:.3f}", contact.p99_penetration_increase_mm),
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
  if (!tissue.mucosa) return "as deep tissue";
  return fmt::format("within {:g} mm of airway and sinuses; {}", tissue.mucosa->thickness_mm,
                     law_in_words(tissue.mucosa->young_mpa, tissue.mucosa->poisson));
}

std::string muscle_in_words(const predict::TissueOptions& tissue) {
  if (!tissue.muscle) return "as deep tissue";
  return "as labeled; " + law_in_words(tissue.muscle->young_mpa, tissue.muscle->poisson);
}

/// The material of the tissue, and which tissues are not distinguished.
std::string material_limits(const predict::TissueOptions& tissue) {
  if (!tissue.skin && !tissue.mucosa && !tissue.muscle)
    return "Soft tissue is one homogeneous, compressible, elastic material without pre-stress "
           "before surgery; skin, fat and muscle are not distinguished.";
  std::string text = "Deep tissue";
  if (tissue.skin) text += ", skin";
  if (tissue.mucosa) text += ", mucosa";
  if (tissue.muscle) text += ", muscle";
  text +=
      " are each a homogeneous, compressible, elastic material without pre-stress before surgery; ";
  if (tissue.muscle) text += "muscle has no fibers and does not contract; ";
  if (tissue.skin) text += "skin is not thinner at the eyelids; ";
  text += "fat";
  if (!tissue.skin) text += ", skin";
  if (!tissue.muscle) text += ", muscle";
  return text + " and other tissues are not distinguished.";
}

std::string skin_in_words(const PreparedCase& prepared) {
  const auto& skin = prepared.plan.tissue.skin;
  if (!skin || !prepared.skin_layer) return "as deep tissue";
  return fmt::format("{} layers, {:g} mm requested, {:.2f} mm mean over {:.0f} % of the skin; {}",
                     skin->layers, skin->thickness_mm, prepared.skin_layer->mean_mm,
                     100.0 * prepared.skin_layer->covered_fraction,
                     law_in_words(skin->young_mpa, skin->poisson));
}

std::string interface_in_words(predict::TissueInterface interface) {
  switch (interface) {
    case predict::TissueInterface::kBonded:
      return "moves with a mobilized segment (bonded)";
    case predict::TissueInterface::kContact:
      return "pushed by a mobilized segment, without friction (contact)";
    default:
      return "bonded, elevated near osteotomies, sliding at teeth and joints (clinical)";
  }
}

std::string outer_boundary_in_words(predict::OuterBoundary boundary) {
  switch (boundary) {
    case predict::OuterBoundary::kFree:
      return "free";
    case predict::OuterBoundary::kFixed:
      return "fixed";
    case predict::OuterBoundary::kFoundation:
      return "elastic foundation";
    default:
      return "roller: no normal displacement";
  }
}

report::ReportTable parameter_table(const PreparedCase& prepared,
                                    const predict::FacePrediction& prediction) {
  const io::PlanFile& plan = prepared.plan;
  const bool is_contact = plan.boundary.interface != predict::TissueInterface::kBonded;
  double segments_mm3 = 0.0, fragments_mm3 = 0.0, cell_mm = 0.0;
  double band_mm = std::numeric_limits<double>::infinity();
  Index fragments = 0, moving = 0;
  for (std::size_t k = 0; k < plan.segments.size(); ++k) {
    segments_mm3 += prepared.cut.volumes_mm3[k];
    for (const plan::Fragment& one : prepared.cut.cuts[k].fragments) {
      fragments_mm3 += one.volume_mm3;
      ++fragments;
      moving += one.owner == plan::FragmentOwner::kSegment;
    }
    cell_mm = std::max(cell_mm, predict::contact_field_B(prepared.model.segments[k])->cell_mm());
    band_mm = std::min(band_mm, predict::contact_field_B(prepared.model.segments[k])->band_mm());
  }
  return {"Model",
          {"quantity", "value"},
          {{"elements", shapes_in_words(prepared.quality)},
           {"nodes", fmt::format("{}", prepared.model.tissue.node_count())},
           {"min dihedral angle", fmt::format("{:.1f}\u00b0", prepared.quality.min_dihedral_deg)},
           {"min scaled Jacobian", fmt::format("{:.3f}", prepared.quality.min_scaled_jacobian)},
           {"soft tissue law", "compressible neo-Hookean"},
           {"Young\u2019s modulus", fmt::format("{:.1f} kPa", kpa_from_mpa(plan.tissue.young_mpa))},
           {"Poisson\u2019s ratio", fmt::format("{:.3f}", plan.tissue.poisson)},
           {"skin", skin_in_words(prepared)},
           {"mucosa", mucosa_in_words(plan.tissue)},
           {"muscle", muscle_in_words(plan.tissue)},
           {"regions", predict::describe_regions(prepared.model.tissue, plan.tissue)},
           {"interface of tissue and bone", interface_in_words(plan.boundary.interface)},
           {"where the scan ends", outer_boundary_in_words(plan.boundary.scan_boundary)},
           {"where the region ends", outer_boundary_in_words(plan.boundary.cut_boundary)},
           {"contact stiffness k_c",
            is_contact ? fmt::format("{:.4f} MPa/mm = {:g} \u00d7 E / node spacing",
                                     prediction.contact_stiffness_mpa_per_mm,
                                     predict::stiffness_factor(plan.contact, plan.tissue))
                       : std::string("\u2013")},
           {"penetration tolerance: depth at a contact pressure of 4 E",
            is_contact && plan.contact.penetration_tolerance_mm
                ? fmt::format("{:g} mm", *plan.contact.penetration_tolerance_mm)
                : std::string("\u2013")},
           {"penetration of tissue into the segment before it moves",
            is_contact ? fmt::format("up to {:.2f} mm", prediction.rest_penetration_mm)
                       : std::string("\u2013")},
           {"distance field of the segment",
            fmt::format("cell {:.3f} mm, band {:.2f} mm", cell_mm, band_mm)},
           {"segment volume", fmt::format("{:.1f} ml", segments_mm3 * 1e-3)},
           {"fragments of the osteotomies",
            fmt::format("{:.2f} ml in {} pieces; {} of them move with a segment",
                        fragments_mm3 * 1e-3, fragments, moving)}}};
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

/// Pairs pictures from the same camera, and adds the others singly.
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

std::string penetration_in_words(const contact::ContactStatistics& contact) {
  constexpr contact::PenetrationLimits kLimits;
  return fmt::format("{:.2f} and {:.2f} mm ({} the limits of {:g} and {:g} mm)",
                     contact.p99_penetration_increase_mm, contact.max_penetration_increase_mm,
                     contact::is_within(kLimits, contact) ? "within" : "exceeds", kLimits.p99_mm,
                     kLimits.max_mm);
}

std::vector<report::KeyNumber> key_numbers(const PreparedCase& prepared,
                                           const predict::FacePrediction& prediction,
                                           const predict::SkinDisplacementStatistics& skin) {
  if (prediction.steps.empty()) return {};
  const contact::ContactStatistics contact = prediction.steps.back().contact_of_all_bones();
  return {{"max skin displacement", fmt::format("{:.1f} mm", skin.max_mm)},
          {"mean displacement where the skin moved by more than 0.5 mm",
           fmt::format("{:.1f} mm", skin.mean_over_moved_mm)},
          {"penetration increase, P99 and max", penetration_in_words(contact)},
          {"steps converged", fmt::format("{} of {}", prediction.steps.size(), prepared.steps())}};
}

std::vector<report::ReportTable> all_tables(const PreparedCase& prepared,
                                            const predict::FacePrediction& prediction,
                                            const std::optional<Timing>& timing) {
  std::vector<report::ReportTable> tables;
  if (prepared.plan.segments.size() > 1 && !prediction.steps.empty())
    tables.push_back(segment_table(prepared, prediction.steps.back()));
  tables.push_back(step_table(prediction));
  tables.push_back(parameter_table(prepared, prediction));
  if (timing) tables.push_back(timing_table(*timing));
  return tables;
}

/// Warnings of the import and of bone overlap.
std::vector<std::string> notes_on(const PreparedCase& prepared) {
  std::vector<std::string> notes = prepared.provenance.warnings;
  if (const predict::BoneOverlapAtFraction* deepest = predict::find_deepest(prepared.overlaps))
    notes.push_back(predict::describe_overlap(*deepest, prepared.plan.segments.size()) +
                    fmt::format("; prediction.json gives the depth at each step, {}*.vtp "
                                "on each segment.",
                                kBoneOverlap));
  return notes;
}

std::vector<report::ProvenanceRow> provenance_rows(const Provenance& provenance) {
  std::vector<report::ProvenanceRow> rows{
      {"lefort version", kVersion},
      {"SHA-256 of the plan", provenance.plan_sha256},
      {"SHA-256 of the scan\u2019s voxels", provenance.ct_sha256},
      {"kind of scan", provenance.ct_kind},
      {"SHA-256 of the labels", provenance.labels_sha256},
      {"labels", provenance.labels_source}};
  for (const auto& [name, sha256] : provenance.plan_files)
    rows.push_back({"SHA-256 of " + name, sha256});
  return rows;
}

std::string interface_limits(predict::TissueInterface interface) {
  if (interface == predict::TissueInterface::kClinical)
    return "The attachment of tissue to bone is assumed from anatomy and procedure, not measured: "
           "bonded, elevated near osteotomies, sliding at teeth and joints, or as painted.";
  return "Tissue on stationary bone is bonded, except near a segment or where it is painted "
         "otherwise.";
}

std::vector<std::string> limitations_of(const PreparedCase& prepared) {
  return {
      material_limits(prepared.plan.tissue),
      ("Linear tetrahedra are too stiff for nearly incompressible tissue. For this reason, "
       "Poisson\u2019s ratio is lower than measured values."),
      ("Tissue outside the tissue mesh does not move, and tissue beyond the scan boundary is not "
       "modeled: near the scan boundary the prediction is not reliable."),
      "Air-filled sinuses are modeled as bone.",
      interface_limits(prepared.plan.boundary.interface),
      "Not validated against postoperative scans."};
}

}  // namespace

report::CaseReport prediction_report(const PreparedCase& prepared,
                                     const predict::FacePrediction& prediction,
                                     std::span<const PredictionPicture> pictures,
                                     const predict::SkinDisplacementStatistics& skin,
                                     const std::optional<Timing>& timing) {
  report::CaseReport report;
  report.title = prepared.plan.title.empty() ? "Predicted face" : prepared.plan.title;
  report.subtitle = "Simulated soft-tissue response to a planned bone movement";
  report.plan = plan_sentence(prepared);
  report.converged = prediction.converged();
  if (prediction.failure) report.failure = prediction.failure->message;
  add_pictures(pictures, report);
  report.key_numbers = key_numbers(prepared, prediction, skin);
  report.tables = all_tables(prepared, prediction, timing);
  report.steps = solver_steps(prediction);
  report.residual_tolerance = prepared.plan.solver.relative_tolerance;
  report.notes = notes_on(prepared);
  report.provenance = provenance_rows(prepared.provenance);
  report.limitations = limitations_of(prepared);
  return report;
}

}  // namespace lefort::pipeline
