#include <lefort/core/units.h>
#include <lefort/pipeline/compare/compare_tables.h>
#include <lefort/pipeline/json/json_values.h>

#include <fmt/format.h>

#include <cmath>

namespace lefort::pipeline {
namespace {

nlohmann::json number(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json();
}

std::string csv_line(const std::string& region, const char* what,
                     const compare::DifferenceStatistics& s) {
  std::string line =
      fmt::format("{},{},{:.1f},{:.4f}", region, what, s.area_mm2, s.compared_fraction);
  for (const double value : {s.mean_mm, s.median_mm, s.p90_mm, s.p95_mm, s.p99_mm, s.max_mm,
                             s.fraction_below_1mm, s.fraction_below_2mm, s.mean_signed_mm})
    line += std::isfinite(value) ? fmt::format(",{:.4f}", value) : ",";
  return line + "\n";
}

using pipeline::as_json;

nlohmann::json as_json(const compare::MovementDifference& d) {
  const Vec3 turn_deg = d.rotation_rad * degrees_from_radians(1.0);
  return {{"translation_mm", as_json(d.translation_mm)},
          {"translation_length_mm", d.translation_mm.norm()},
          {"rotation_deg", as_json(turn_deg)},
          {"rotation_angle_deg", turn_deg.norm()},
          {"max_displacement_mm", d.max_mm}};
}

/// "1.20 mm left, 6.01 mm forward, 0.33 mm up": L has x to the left, y back, z up.
std::string anatomical(const Vec3& translation_mm) {
  return fmt::format("{:.2f} mm {}, {:.2f} mm {}, {:.2f} mm {}", std::abs(translation_mm.x()),
                     translation_mm.x() < 0.0 ? "right" : "left", std::abs(translation_mm.y()),
                     translation_mm.y() < 0.0 ? "forward" : "back", std::abs(translation_mm.z()),
                     translation_mm.z() < 0.0 ? "down" : "up");
}

}  // namespace

nlohmann::json statistics_json(const compare::DifferenceStatistics& s) {
  return {{"area_mm2", s.area_mm2},
          {"compared_fraction", s.compared_fraction},
          {"mean_mm", number(s.mean_mm)},
          {"median_mm", number(s.median_mm)},
          {"p90_mm", number(s.p90_mm)},
          {"p95_mm", number(s.p95_mm)},
          {"p99_mm", number(s.p99_mm)},
          {"max_mm", number(s.max_mm)},
          {"fraction_below_1mm", number(s.fraction_below_1mm)},
          {"fraction_below_2mm", number(s.fraction_below_2mm)},
          {"mean_signed_mm", number(s.mean_signed_mm)}};
}

nlohmann::json regions_json(std::span<const compare::RegionDifference> rows) {
  nlohmann::json lines = nlohmann::json::array();
  for (const compare::RegionDifference& row : rows) {
    lines.push_back({{"region", row.region}, {"face", statistics_json(row.face)}});
    if (row.baseline) lines.back()["baseline_no_change"] = statistics_json(*row.baseline);
  }
  return lines;
}

std::string regions_csv(std::span<const compare::RegionDifference> rows) {
  std::string csv =
      "region,face,area_mm2,compared_fraction,mean_mm,median_mm,p90_mm,p95_mm,p99_mm,max_mm,"
      "fraction_below_1mm,fraction_below_2mm,mean_signed_mm\n";
  for (const compare::RegionDifference& row : rows) {
    csv += csv_line(row.region, "compared", row.face);
    if (row.baseline) csv += csv_line(row.region, "baseline (no change)", *row.baseline);
  }
  return csv;
}

std::string regions_text(std::span<const compare::RegionDifference> rows) {
  std::string text = fmt::format("  {:<16} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7}", "[mm]",
                                 "mean", "median", "P90", "P95", "P99", "max", "< 1 mm", "< 2 mm");
  const auto add = [&](const std::string& name, const compare::DifferenceStatistics& s) {
    text += fmt::format(
        "\n  {:<16} {:7.2f} {:7.2f} {:7.2f} {:7.2f} {:7.2f} {:7.2f} {:5.0f} % {:5.0f} %", name,
        s.mean_mm, s.median_mm, s.p90_mm, s.p95_mm, s.p99_mm, s.max_mm,
        100.0 * s.fraction_below_1mm, 100.0 * s.fraction_below_2mm);
    if (s.compared_fraction < 0.95)
      text += fmt::format("  of {:.0f} % of the area", 100.0 * s.compared_fraction);
  };
  for (const compare::RegionDifference& row : rows) {
    add(row.region, row.face);
    if (row.baseline) add("  no change", *row.baseline);
  }
  return text;
}

nlohmann::json registration_json(const compare::Registration& r) {
  return {{"matrix", as_json(r.X_onto_from)},
          {"rms_mm", r.rms_mm},
          {"inlier_fraction", r.inlier_fraction},
          {"stability", r.stability}};
}

nlohmann::json movements_json(const SurgeryFound& surgery) {
  nlohmann::json lines = nlohmann::json::array();
  for (const compare::AchievedMovement& one : surgery.movements)
    lines.push_back({{"segment", one.segment},
                     {"registration", registration_json(one.achieved)},
                     {"achieved", as_json(one.movement)},
                     {"from_plan_to_achieved", as_json(one.error)}});
  return lines;
}

std::string movements_csv(const SurgeryFound& surgery) {
  std::string csv =
      "segment,what,left_mm,back_mm,up_mm,length_mm,rotation_x_deg,rotation_y_deg,rotation_z_deg,"
      "rotation_deg,"
      "max_displacement_mm\n";
  const auto add = [&](const std::string& segment, const char* what,
                       const compare::MovementDifference& d) {
    const Vec3 turn_deg = d.rotation_rad * degrees_from_radians(1.0);
    csv += fmt::format("{},{},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f}\n",
                       segment, what, d.translation_mm.x(), d.translation_mm.y(),
                       d.translation_mm.z(), d.translation_mm.norm(), turn_deg.x(), turn_deg.y(),
                       turn_deg.z(), turn_deg.norm(), d.max_mm);
  };
  for (const compare::AchievedMovement& one : surgery.movements) {
    add(one.segment, "achieved", one.movement);
    add(one.segment, "from plan to achieved", one.error);
  }
  return csv;
}

std::string movements_text(const SurgeryFound& surgery) {
  std::string text =
      fmt::format("\n  registered on stationary bone: rms {:.2f} mm, inlier fraction {:.0f} %",
                  surgery.base.rms_mm, 100.0 * surgery.base.inlier_fraction);
  for (const compare::AchievedMovement& one : surgery.movements)
    text += fmt::format(
        "\n  {}: moved {}, rotated {:.2f} deg; {:.2f} mm and {:.2f} deg from the plan", one.segment,
        anatomical(one.movement.translation_mm),
        degrees_from_radians(one.movement.rotation_rad.norm()), one.error.translation_mm.norm(),
        degrees_from_radians(one.error.rotation_rad.norm()));
  return text;
}

}  // namespace lefort::pipeline
