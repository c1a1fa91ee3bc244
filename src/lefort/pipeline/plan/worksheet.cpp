#include <lefort/geometry/rigid_path.h>
#include <lefort/pipeline/plan/worksheet.h>
#include <lefort/plan/bones_of_landmarks.h>
#include <lefort/report/sheet_pdf.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <utility>

namespace lefort::pipeline {
namespace {

constexpr std::size_t kShownDigits = 16;  // Of a SHA-256.

std::vector<std::string> movement_cells(const std::string& name, const plan::MovementTerms& terms) {
  return {name, movement_in_words(terms.anterior_mm, "forward", "back"),
          movement_in_words(terms.superior_mm, "up", "down"),
          movement_in_words(terms.left_mm, "to left", "to right")};
}

nlohmann::json terms_json(const plan::MovementTerms& terms) {
  return {{"anterior_mm", terms.anterior_mm}, {"left_mm", terms.left_mm},
          {"superior_mm", terms.superior_mm}, {"yaw_deg", terms.yaw_deg},
          {"pitch_deg", terms.pitch_deg},     {"roll_deg", terms.roll_deg}};
}

/// "right profile" of plan_after_right_profile.png.
std::string view_of(const std::string& file) {
  constexpr std::string_view kBefore = "plan_after_", kAfter = ".png";
  std::string view = file;
  if (view.starts_with(kBefore)) view.erase(0, kBefore.size());
  if (view.ends_with(kAfter)) view.resize(view.size() - kAfter.size());
  std::replace(view.begin(), view.end(), '_', ' ');
  return view;
}

Vec3 center_of_surface(const geometry::TriangleMesh& mesh) {
  Vec3 sum = Vec3::Zero();
  double area = 0.0;
  for (Index t = 0; t < mesh.triangle_count(); ++t) {
    const Vec3 &a = mesh.corner(t, 0), &b = mesh.corner(t, 1), &c = mesh.corner(t, 2);
    const double weight = (b - a).cross(c - a).norm();
    sum += weight * (a + b + c) / 3.0;
    area += weight;
  }
  return area > 0.0 ? Vec3(sum / area) : Vec3::Zero();
}

report::ReportTable rotations_table(std::span<const MovementOfSegment> movements) {
  report::ReportTable table{
      "Segments (translation of the center of the surface, mm; rotation, degrees)",
      {"segment", "anterior", "superior", "lateral", "yaw", "pitch", "roll"},
      {}};
  for (const MovementOfSegment& one : movements) {
    std::vector<std::string> row = movement_cells(one.segment, one.whole);
    row.push_back(movement_in_words(one.whole.yaw_deg, "front to left", "front to right"));
    row.push_back(movement_in_words(one.whole.pitch_deg, "front down", "front up"));
    row.push_back(movement_in_words(one.whole.roll_deg, "left side up", "left side down"));
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

std::string movement_in_words(double value, const char* positive, const char* negative) {
  constexpr double kShown = 0.05;
  if (std::abs(value) < kShown) return "-";
  return fmt::format("{:.1f} {}", std::abs(value), value > 0.0 ? positive : negative);
}

std::vector<MovementOfSegment> segment_movements(const plan::HeadDirections& directions,
                                                 const plan::Landmarks& landmarks,
                                                 const plan::CutSegments& cut,
                                                 std::span<const plan::PlannedSegment> planned) {
  const auto bones = plan::bones_of_landmarks(landmarks, cut);
  std::vector<MovementOfSegment> movements;
  for (std::size_t k = 0; k < planned.size(); ++k) {
    const RigidTransform X_LB = geometry::pose_at(planned[k].path, 1.0);
    if (X_LB.isApprox(RigidTransform::Identity(), 1e-9)) continue;
    MovementOfSegment movement{
        planned[k].osteotomy.segment,
        plan::movement_terms(X_LB, center_of_surface(cut.segments_L[k]), directions),
        {}};
    for (std::size_t n = 0; n < landmarks.size(); ++n) {
      const plan::LandmarkKind* const kind = plan::landmark_definition(landmarks[n].name);
      if (bones[n] == k && (kind == nullptr || !kind->is_soft))
        movement.landmarks.emplace_back(
            landmarks[n].name, plan::movement_terms(X_LB, landmarks[n].point_L, directions));
    }
    movements.push_back(std::move(movement));
  }
  return movements;
}

nlohmann::json movements_json(std::span<const MovementOfSegment> movements) {
  nlohmann::json list = nlohmann::json::array();
  for (const MovementOfSegment& one : movements) {
    nlohmann::json points = nlohmann::json::object();
    for (const auto& [name, terms] : one.landmarks) points[name] = terms_json(terms);
    list.push_back(
        {{"segment", one.segment}, {"center", terms_json(one.whole)}, {"landmarks", points}});
  }
  return list;
}

std::string movements_csv(std::span<const MovementOfSegment> movements) {
  std::string text = "segment,point,anterior_mm,left_mm,superior_mm,yaw_deg,pitch_deg,roll_deg\n";
  const auto add = [&](const std::string& segment, const std::string& point,
                       const plan::MovementTerms& terms) {
    text += fmt::format("{},{},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f}\n", segment, point,
                        terms.anterior_mm, terms.left_mm, terms.superior_mm, terms.yaw_deg,
                        terms.pitch_deg, terms.roll_deg);
  };
  for (const MovementOfSegment& one : movements) {
    add(one.segment, "center", one.whole);
    for (const auto& [name, terms] : one.landmarks) add(one.segment, name, terms);
  }
  return text;
}

Result<std::string> worksheet_pdf(const WorksheetNotes& notes,
                                  std::span<const MovementOfSegment> movements,
                                  std::span<const predict::PlanFinding> findings,
                                  std::span<const report::PlanPicture> pictures) {
  report::Sheet sheet;
  sheet.title = notes.title.empty() ? std::string("Worksheet") : "Worksheet: " + notes.title;
  sheet.lines = {
      "Movements of the planned segments from their position in the CT. Left and right "
      "are the patient's. Rotations: yaw, then pitch, then roll."};
  sheet.lines.push_back(notes.has_frankfurt_horizontal
                            ? "Anterior is along the Frankfurt horizontal."
                            : "The Frankfurt horizontal is not known: directions are of the scan.");
  sheet.lines.push_back("Plan: SHA-256 " + notes.plan_sha256.substr(0, kShownDigits));
  if (findings.empty()) sheet.lines.push_back("Check: no findings within the limits.");
  for (const predict::PlanFinding& finding : findings)
    sheet.lines.push_back("Check: " + finding.text);
  sheet.pictures_per_row = 4;
  for (const report::PlanPicture& picture : pictures)
    if (picture.file.find("after") != std::string::npos)
      sheet.pictures.push_back({view_of(picture.file), "", picture.png});
  sheet.tables.push_back(rotations_table(movements));
  for (const MovementOfSegment& one : movements) {
    if (one.landmarks.empty()) continue;
    report::ReportTable table{fmt::format("Landmarks of {} [mm]", one.segment),
                              {"landmark", "anterior", "superior", "lateral"},
                              {}};
    for (const auto& [name, terms] : one.landmarks)
      table.rows.push_back(movement_cells(plan::full_name(name), terms));
    sheet.tables.push_back(std::move(table));
  }
  if (!notes.parts.empty()) {
    report::ReportTable table{"Splints and guides", {"", "file", "SHA-256"}, {}};
    for (const auto& [kind, name, sha256] : notes.parts)
      table.rows.push_back({kind, name, sha256.substr(0, kShownDigits)});
    sheet.tables.push_back(std::move(table));
  }
  return report::sheet_pdf(sheet);
}

}  // namespace lefort::pipeline
