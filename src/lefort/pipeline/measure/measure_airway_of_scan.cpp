#include <lefort/anatomy/extract_surface.h>
#include <lefort/anatomy/measure_airway.h>
#include <lefort/anatomy/pad_volume.h>
#include <lefort/core/version.h>
#include <lefort/io/output_folder.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/airway.h>
#include <lefort/pipeline/json/json_values.h>
#include <lefort/pipeline/prepare/oriented_head.h>
#include <lefort/report/plot_lines.h>

#include <fmt/format.h>

#include <array>
#include <string>

namespace lefort::pipeline {
namespace {

using anatomy::Airway;
using anatomy::AirwaySection;

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
  summary.text +=
      "\n  breathing, swallowing and the position of the tongue change the airway within seconds";
  summary.text += fmt::format("\n{}", kNotForClinicalUse);
  return summary;
}

Result<void> write_files(const AirwayJob& job, const Airway& airway, const Summary& summary,
                         Progress& progress) {
  constexpr float kOutside = -0.5F;
  LEFORT_TRY(
      const geometry::TriangleMesh surface_L,
      anatomy::extract_isosurface(
          anatomy::padded(airway.level, anatomy::margin_all_around(1), kOutside), {}, progress));
  LEFORT_TRY_VOID(io::make_output_folder(job.output));
  LEFORT_TRY_VOID(io::write_surface(job.output / "airway.vtp", surface_L));
  LEFORT_TRY_VOID(io::write_text(job.output / "airway.csv", sections_csv(airway)));
  LEFORT_TRY_VOID(io::write_text(job.output / "airway.svg", areas_plot(airway)));
  return io::write_text(job.output / "airway.json", summary.json.dump(1) + "\n");
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
  const Summary summary = summary_of(airway, job, head, limits);
  LEFORT_TRY_VOID(write_files(job, airway, summary, progress));
  return summary;
}

}  // namespace lefort::pipeline
