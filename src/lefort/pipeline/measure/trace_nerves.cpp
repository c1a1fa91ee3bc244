#include <lefort/anatomy/minimal_path.h>
#include <lefort/anatomy/trace_nerve.h>
#include <lefort/core/version.h>
#include <lefort/geometry/tube_surface.h>
#include <lefort/io/earlier_check_files.h>
#include <lefort/io/landmarks_file.h>
#include <lefort/io/output_folder.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/json/json_values.h>
#include <lefort/pipeline/nerve.h>
#include <lefort/pipeline/prepare/oriented_head.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;

/// Canals have a diameter of 2 to 4 mm.
constexpr double kCanalRadius_mm = 1.5;
constexpr double kVisibleEnough = 0.6;

struct SideName {
  const char* letter;
  const char* name;
  double to_left;  ///< 1 for the left side, -1 for the right one.
};
constexpr std::array<SideName, 2> kSides{{{"R", "right", -1.0}, {"L", "left", 1.0}}};

/// Points whose names are the prefix and a number, by number.
Result<std::vector<Vec3>> points_on_canal(std::span<const plan::Landmark> landmarks,
                                          const std::string& prefix) {
  std::map<int, Vec3> numbered;
  for (const plan::Landmark& one : landmarks) {
    if (!one.name.starts_with(prefix)) continue;
    int number = 0;
    const char* const first = one.name.data() + prefix.size();
    const char* const last = one.name.data() + one.name.size();
    const auto [end, error] = std::from_chars(first, last, number);
    if (error != std::errc() || end != last)
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("the landmark {} must end in a number: its place on the canal, from "
                              "posterior to anterior",
                              one.name));
    numbered[number] = one.point_L;
  }
  std::vector<Vec3> points_L;
  points_L.reserve(numbered.size());
  for (const auto& [number, point_L] : numbered) points_L.push_back(point_L);
  return points_L;
}

Result<anatomy::MandibleSide> side_of(const OrientedHead& head, const SideName& side) {
  const auto sided = [&](const char* name) { return fmt::format("{}-{}", name, side.letter); };
  anatomy::MandibleSide jaw;
  jaw.lateral_L = side.to_left * head.directions.left_L;
  jaw.anterior_L = head.directions.anterior_L;
  jaw.superior_L = head.directions.superior_L;
  LEFORT_TRY(jaw.pogonion_L, needed_landmark(head.landmarks, "Pg"));
  LEFORT_TRY(jaw.gonion_L, needed_landmark(head.landmarks, sided("Go")));
  LEFORT_TRY(jaw.condylion_L, needed_landmark(head.landmarks, sided("Co")));
  jaw.mandibular_foramen_L = plan::find_landmark(head.landmarks, sided("MdF"));
  jaw.mental_foramen_L = plan::find_landmark(head.landmarks, sided("MeF"));
  LEFORT_TRY(jaw.points_L, points_on_canal(head.landmarks, fmt::format("IAN-{}-", side.letter)));
  return jaw;
}

/// Both foramina, and a point every 10 mm between.
void add_points(const anatomy::NerveCanal& canal, const SideName& side, plan::Landmarks& points) {
  constexpr std::size_t kStep = 20;  // Points of the line are 0.5 mm from each other.
  points.push_back({fmt::format("MdF-{}", side.letter), canal.line_L.front()});
  for (std::size_t n = kStep, number = 1; n + kStep / 2 < canal.line_L.size(); n += kStep, ++number)
    points.push_back({fmt::format("IAN-{}-{}", side.letter, number), canal.line_L[n]});
  points.push_back({fmt::format("MeF-{}", side.letter), canal.line_L.back()});
}

nlohmann::json canal_json(const anatomy::NerveCanal& canal) {
  nlohmann::json points = nlohmann::json::array();
  for (const Vec3& p_L : canal.line_L) points.push_back(as_json(p_L));
  return {{"length_mm", anatomy::length_mm(canal.line_L)},
          {"radius_mm", kCanalRadius_mm},
          {"visible_fraction", canal.visible_fraction},
          {"mandibular_foramen", as_json(canal.line_L.front())},
          {"mental_foramen", as_json(canal.line_L.back())},
          {"points", points},
          {"hu", canal.hu}};
}

std::string canal_text(const anatomy::NerveCanal& canal, const SideName& side) {
  std::string text =
      fmt::format("\n  {:<5} {:.0f} mm, darker than the bone around it along {:.0f} %", side.name,
                  anatomy::length_mm(canal.line_L), 100.0 * canal.visible_fraction);
  if (canal.visible_fraction < kVisibleEnough)
    text +=
        "\n    warning: the canal is hardly visible; check it, and give points on it "
        "(--landmarks)";
  return text;
}

Result<void> write_canal(const fs::path& file, const anatomy::NerveCanal& canal) {
  constexpr int kCorners = 16;
  const geometry::TriangleMesh tube_L =
      geometry::tube_surface(canal.line_L, kCanalRadius_mm, kCorners);
  std::vector<double> hu;
  for (const double value : canal.hu) hu.insert(hu.end(), kCorners, value);
  hu.push_back(canal.hu.front());
  hu.push_back(canal.hu.back());
  return io::write_surface(file, tube_L, {{"hu", hu}});
}

}  // namespace

Result<Summary> trace_nerves(const NerveJob& job, Progress& progress) {
  const std::array<std::string, 9> needed{"Pg",   "Go-R", "Go-L", "Co-R", "Co-L",
                                          "Or-R", "Or-L", "Po-R", "Po-L"};
  const std::array<fs::path, 1> written{job.output / "nerve.mrk.json"};
  if (job.landmarks) LEFORT_TRY_VOID(io::check_inputs_are_distinct({&*job.landmarks, 1}, written));
  LEFORT_TRY(const OrientedHead head,
             oriented_head({job.ct, job.labels, job.landmarks}, needed, progress));
  if (!has_mandible(head.scanned.labels))
    return fail(ErrorCode::kAnatomyMissing, "the labels have no mandible");
  progress.begin_stage("trace the canals");
  std::vector<anatomy::NerveCanal> canals;
  for (const SideName& side : kSides) {
    LEFORT_TRY(const anatomy::MandibleSide jaw, side_of(head, side));
    auto canal = anatomy::trace_nerve(head.scanned.scan.ct, head.scanned.labels, jaw);
    if (!canal)
      return fail(canal.error().code, fmt::format("{} side: {}", side.name, canal.error().message));
    canals.push_back(*std::move(canal));
  }
  LEFORT_TRY_VOID(io::make_output_folder(job.output));
  Summary summary{
      job.output.string() + ": canals of the inferior alveolar nerves",
      {{"lefort_nerve", 1}, {"notice", kNotForClinicalUse}, {"ct_sha256", head.scanned.ct_sha256}}};
  plan::Landmarks points;
  for (std::size_t n = 0; n < kSides.size(); ++n) {
    summary.json[kSides[n].name] = canal_json(canals[n]);
    summary.text += canal_text(canals[n], kSides[n]);
    add_points(canals[n], kSides[n], points);
    LEFORT_TRY_VOID(
        write_canal(job.output / fmt::format("nerve_{}.vtp", kSides[n].name), canals[n]));
  }
  summary.text += fmt::format(
      "\n  errors of 1 mm are usual, of 2 to 5 mm occur at the foramina: check the course\n{}",
      kNotForClinicalUse);
  LEFORT_TRY_VOID(io::write_landmarks(job.output / "nerve.mrk.json", points));
  LEFORT_TRY_VOID(io::write_text(job.output / "nerve.json", summary.json.dump(1) + "\n"));
  return summary;
}

}  // namespace lefort::pipeline
