#include <lefort/anatomy/extract_surface.h>
#include <lefort/anatomy/measure_airway.h>
#include <lefort/anatomy/pad_volume.h>
#include <lefort/anatomy/warp_volume.h>
#include <lefort/core/parallel.h>
#include <lefort/core/version.h>
#include <lefort/io/output_folder.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/airway.h>
#include <lefort/pipeline/json/json_values.h>
#include <lefort/pipeline/measure/predicted_movement.h>
#include <lefort/pipeline/prepare/oriented_head.h>
#include <lefort/report/plot_lines.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <vector>

namespace lefort::pipeline {
namespace {

using anatomy::Airway;
using anatomy::AirwaySection;

/// Volume over length: without the effect of limits that move.
double mean_area_mm2(const Airway& airway) {
  return airway.length_mm > 0.0 ? 1e3 * airway.volume_ml / airway.length_mm : 0.0;
}

nlohmann::json section_json(const AirwaySection& section) {
  return {{"area_mm2", section.area_mm2},        {"width_mm", section.width_mm},
          {"depth_mm", section.depth_mm},        {"along_mm", section.along_mm},
          {"center", as_json(section.center_L)}, {"normal", as_json(section.normal_L)}};
}

std::string sections_csv(const Airway& airway) {
  std::string text = "along_mm,area_mm2,width_mm,depth_mm,axial_area_mm2,x_mm,y_mm,z_mm\n";
  for (std::size_t n = 0; n < airway.sections.size(); ++n) {
    const AirwaySection& one = airway.sections[n];
    text += fmt::format("{:.2f},{:.2f},{:.2f},{:.2f},{:.2f},{:.2f},{:.2f},{:.2f}\n", one.along_mm,
                        one.area_mm2, one.width_mm, one.depth_mm, airway.axial[n].area_mm2,
                        one.center_L.x(), one.center_L.y(), one.center_L.z());
  }
  return text;
}

std::string areas_plot(const Airway& airway) {
  report::LinePlot plot;
  plot.title = "Cross-sections of the airway";
  plot.x_label = "along the center line, from superior [mm]";
  plot.y_label = "area [mm2]";
  plot.lines = {{"normal to the center line"}, {"axial"}};
  for (std::size_t n = 0; n < airway.sections.size(); ++n) {
    plot.lines[0].x.push_back(airway.sections[n].along_mm);
    plot.lines[0].y.push_back(airway.sections[n].area_mm2);
    plot.lines[1].x.push_back(airway.axial[n].along_mm);
    plot.lines[1].y.push_back(airway.axial[n].area_mm2);
  }
  return report::plot_file(plot);
}

/// All files of this command.
std::vector<std::filesystem::path> files_of(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files{folder / "airway.json"};
  for (const char* const name : {"airway", "airway_after"})
    for (const char* const ending : {".vtp", ".csv", ".svg"})
      files.push_back(folder / (std::string(name) + ending));
  return files;
}

Result<geometry::TriangleMesh> wall_of(const Airway& airway, Progress& progress) {
  constexpr float kOutside = -0.5F;
  return anatomy::extract_isosurface(
      anatomy::padded(airway.level, anatomy::margin_all_around(1), kOutside), {}, progress);
}

/// Writes NAME.vtp, .csv and .svg.
Result<void> write_airway(const std::filesystem::path& folder, const std::string& name,
                          const Airway& airway, Progress& progress) {
  LEFORT_TRY(const geometry::TriangleMesh wall_L, wall_of(airway, progress));
  LEFORT_TRY_VOID(io::write_surface(folder / (name + ".vtp"), wall_L));
  LEFORT_TRY_VOID(io::write_text(folder / (name + ".csv"), sections_csv(airway)));
  return io::write_text(folder / (name + ".svg"), areas_plot(airway));
}

/// Moves the scan and its limits as a prediction does.
struct PredictedScan {
  image::CtVolume ct;
  anatomy::LabelMap labels;
  anatomy::AirwayLimits limits;
  double covered = 0.0;  ///< Part of the wall of the airway near soft tissue of the prediction.
};

/// Part of the surface of the airway within 6 mm of a node of the tissue mesh.
double covered_part(const geometry::TriangleMesh& wall_L, const std::vector<Vec3>& tissue_L) {
  constexpr double kNear_mm = 6.0;
  std::map<std::array<Index, 3>, std::vector<Vec3>> cells;
  const auto cell_of = [&](const Vec3& p) {
    const Vec3 at = (p / kNear_mm).array().floor();
    return std::array{Index(at.x()), Index(at.y()), Index(at.z())};
  };
  for (const Vec3& p_L : tissue_L) cells[cell_of(p_L)].push_back(p_L);
  const auto is_near = [&](const Vec3& p_L) {
    const std::array<Index, 3> at = cell_of(p_L);
    for (Index n = 0; n < 27; ++n) {
      const auto found = cells.find({at[0] + n % 3 - 1, at[1] + n / 3 % 3 - 1, at[2] + n / 9 - 1});
      if (found == cells.end()) continue;
      for (const Vec3& q_L : found->second)
        if ((q_L - p_L).norm() < kNear_mm) return true;
    }
    return false;
  };
  const auto near = std::count_if(wall_L.vertices.begin(), wall_L.vertices.end(), is_near);
  return double(near) / double(std::max<std::size_t>(wall_L.vertices.size(), 1));
}

/// Labels of the airway after the movement: that of the voxel before it.
anatomy::LabelMap warped_labels(const anatomy::LabelMap& labels,
                                const anatomy::DisplacementField& field) {
  anatomy::LabelMap after = labels;
  parallel_for(labels.grid.voxel_count(), [&](Index v) {
    const Vec3 at = labels.grid.index_V(field.before(labels.grid.center_L(v)));
    const auto i = Index(std::lround(at.x())), j = Index(std::lround(at.y())),
               k = Index(std::lround(at.z()));
    after.values[std::size_t(v)] =
        labels.grid.contains(i, j, k) ? labels.at(i, j, k) : anatomy::Tissue::kBackground;
  });
  return after;
}

Result<PredictedScan> predicted_scan(const AirwayJob& job, const OrientedHead& head,
                                     const anatomy::AirwayLimits& limits,
                                     const geometry::TriangleMesh& wall_L, Progress& progress) {
  constexpr std::int16_t kAir_hu = -1000;
  LEFORT_TRY(const PredictedMovement movement, predicted_movement(*job.prediction, progress));
  if (movement.ct_sha256.empty())
    progress.note("the prediction does not state its scan: check that it is of this one");
  else if (movement.ct_sha256 != head.scanned.ct_sha256)
    return fail(ErrorCode::kInvalidArgument,
                "the prediction is of another scan than the one that is measured");
  progress.begin_stage("move the scan");
  const image::CtVolume& ct = head.scanned.scan.ct;
  Box3 box_L;
  for (int corner = 0; corner < 8; ++corner)
    box_L.extend(ct.grid.point_L({(corner & 1) != 0 ? double(ct.grid.size[0] - 1) : 0.0,
                                  (corner & 2) != 0 ? double(ct.grid.size[1] - 1) : 0.0,
                                  (corner & 4) != 0 ? double(ct.grid.size[2] - 1) : 0.0}));
  const anatomy::DisplacementField field(movement.points, box_L);
  PredictedScan after{anatomy::warped(ct, field, kAir_hu),
                      warped_labels(head.scanned.labels, field), limits,
                      covered_part(wall_L, movement.tissue_L)};
  for (Vec3* const p_L : {&after.limits.upper_L, &after.limits.lower_L, &after.limits.front_L})
    *p_L += field.at(*p_L);
  return after;
}

/// Adds what the airway would be after the movement.
Result<void> add_after(const AirwayJob& job, const OrientedHead& head,
                       const anatomy::AirwayLimits& limits, const Airway& before,
                       const geometry::TriangleMesh& wall_L, Summary& summary, Progress& progress) {
  constexpr double kMinCovered = 0.5;
  LEFORT_TRY(const PredictedScan scan, predicted_scan(job, head, limits, wall_L, progress));
  progress.begin_stage("measure the predicted airway");
  LEFORT_TRY(const Airway after, anatomy::measure_airway(scan.ct, scan.labels, scan.limits));
  const AirwaySection& narrow = after.sections[after.min_section];
  summary.json["after"] = {{"volume_ml", after.volume_ml},
                           {"length_mm", after.length_mm},
                           {"mean_area_mm2", mean_area_mm2(after)},
                           {"closed_mm", after.closed_mm},
                           {"min_section", section_json(narrow)},
                           {"min_axial_section", section_json(after.axial[after.min_axial])},
                           {"wall_in_tissue_mesh", scan.covered}};
  summary.text += fmt::format(
      "\n  after the predicted movement: volume {:.2f} ml ({:+.2f}) along {:.0f} mm, mean area "
      "{:.0f} mm2 ({:+.0f}), smallest section {:.0f} mm2 ({:+.0f})\n  {:.0f} % of the wall of the "
      "airway lies in the tissue of the prediction",
      after.volume_ml, after.volume_ml - before.volume_ml, after.length_mm, mean_area_mm2(after),
      mean_area_mm2(after) - mean_area_mm2(before), narrow.area_mm2,
      narrow.area_mm2 - before.sections[before.min_section].area_mm2, 100.0 * scan.covered);
  if (scan.covered < kMinCovered)
    summary.text +=
        "\n  warning: soft palate and tongue are mostly outside of this tissue; elsewhere the wall "
        "follows the points around it, or stays";
  return write_airway(job.output, "airway_after", after, progress);
}

/// \param limits  of the airway.
Summary summary_of(const Airway& airway, const AirwayJob& job, const OrientedHead& head,
                   const anatomy::AirwayLimits& limits) {
  // Ends of the center line.
  const double below_mm = limits.superior_L.dot(limits.upper_L - airway.sections.front().center_L);
  const double above_mm = limits.superior_L.dot(airway.sections.back().center_L - limits.lower_L);
  const AirwaySection& narrow = airway.sections[airway.min_section];
  const AirwaySection& axial = airway.axial[airway.min_axial];
  Summary summary;
  summary.json = {{"lefort_airway", 1},
                  {"notice", kNotForClinicalUse},
                  {"upper", job.upper},
                  {"lower", job.lower},
                  {"front", job.front},
                  {"has_frankfurt_horizontal", head.directions.has_frankfurt_horizontal},
                  {"volume_ml", airway.volume_ml},
                  {"length_mm", airway.length_mm},
                  {"mean_area_mm2", mean_area_mm2(airway)},
                  {"closed_mm", airway.closed_mm},
                  {"below_upper_mm", below_mm},
                  {"above_lower_mm", above_mm},
                  {"min_section", section_json(narrow)},
                  {"min_axial_section", section_json(axial)}};
  summary.text = fmt::format(
      "{}: airway from {} to {}\n  volume {:.2f} ml, center line {:.0f} mm\n  smallest section "
      "{:.0f} mm2 ({:.1f} mm wide, {:.1f} mm deep), {:.0f} mm below the upper end\n  smallest "
      "axial "
      "section {:.0f} mm2",
      job.output.string(), job.upper, job.lower, airway.volume_ml, airway.length_mm,
      narrow.area_mm2, narrow.width_mm, narrow.depth_mm, narrow.along_mm, axial.area_mm2);
  if (airway.closed_mm > 0.0)
    summary.text += fmt::format("\n  the airway is closed along {:.0f} mm", airway.closed_mm);
  constexpr double kNotice_mm = 3.0;
  if (below_mm > kNotice_mm)
    summary.text += fmt::format("\n  the airway starts {:.0f} mm below the upper limit", below_mm);
  if (above_mm > kNotice_mm)
    summary.text += fmt::format("\n  the airway ends {:.0f} mm above the lower limit", above_mm);
  if (!head.directions.has_frankfurt_horizontal)
    summary.text +=
        "\n  the planes are parallel to the scan: the Frankfurt horizontal is not known";
  return summary;
}

}  // namespace

Result<Summary> measure_airway_of_scan(const AirwayJob& job, Progress& progress) {
  // With all of these in the file no landmark is searched.
  std::array<std::string, 5> needed{"Or", "Po", job.upper, job.lower, job.front};
  for (std::string& name : needed)
    if (name.find(',') != std::string::npos) name = "Or";
  LEFORT_TRY(const OrientedHead head,
             oriented_head({job.ct, job.labels, job.landmarks}, needed, progress));
  anatomy::AirwayLimits limits;
  limits.superior_L = head.directions.superior_L;
  limits.anterior_L = head.directions.anterior_L;
  LEFORT_TRY(limits.upper_L, named_point(head.landmarks, job.upper));
  LEFORT_TRY(limits.lower_L, named_point(head.landmarks, job.lower));
  LEFORT_TRY(limits.front_L, named_point(head.landmarks, job.front));
  progress.begin_stage("measure the airway");
  LEFORT_TRY(const Airway airway,
             anatomy::measure_airway(head.scanned.scan.ct, head.scanned.labels, limits));
  Summary summary = summary_of(airway, job, head, limits);
  const io::EmptyFolderCleanup none_left(job.output);
  LEFORT_TRY_VOID(io::make_output_folder(job.output));
  LEFORT_TRY_VOID(io::remove_earlier_files(files_of(job.output)));
  if (progress.stop_requested())
    return fail(ErrorCode::kCancelled, "the measurement was cancelled");
  if (job.prediction) {
    LEFORT_TRY(const geometry::TriangleMesh wall_L, wall_of(airway, progress));
    LEFORT_TRY_VOID(add_after(job, head, limits, airway, wall_L, summary, progress));
  }
  LEFORT_TRY_VOID(write_airway(job.output, "airway", airway, progress));
  summary.text +=
      "\n  breathing, swallowing and the position of the tongue change the airway within seconds";
  summary.text += fmt::format("\n{}", kNotForClinicalUse);
  LEFORT_TRY_VOID(io::write_text(job.output / "airway.json", summary.json.dump(1) + "\n"));
  return summary;
}

}  // namespace lefort::pipeline
