#include <lefort/anatomy/find_teeth.h>
#include <lefort/core/version.h>
#include <lefort/io/earlier_check_files.h>
#include <lefort/io/landmarks_file.h>
#include <lefort/io/output_folder.h>
#include <lefort/io/segmentation_file.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/dental.h>
#include <lefort/pipeline/dental/dental_numbers.h>
#include <lefort/pipeline/dental/teeth_file.h>
#include <lefort/pipeline/json/json_values.h>
#include <lefort/pipeline/prepare/oriented_head.h>

#include <fmt/format.h>

#include <array>
#include <string>
#include <utility>
#include <vector>

namespace lefort::pipeline {
namespace {

nlohmann::json tooth_json(const dental::NumberedTooth& tooth) {
  return {{"fdi", tooth.fdi},
          {"crown", as_json(tooth.crown_L)},
          {"apex", as_json(tooth.apex_L)},
          {"axis", as_json(tooth.axis_L)},
          {"length_mm", tooth.length_mm},
          {"width_mm", tooth.width_mm},
          {"volume_mm3", tooth.volume_mm3}};
}

std::string teeth_csv(const std::vector<dental::NumberedTooth>& teeth) {
  std::string text =
      "fdi,crown_x_mm,crown_y_mm,crown_z_mm,apex_x_mm,apex_y_mm,apex_z_mm,length_mm,width_mm,"
      "volume_mm3\n";
  for (const dental::NumberedTooth& one : teeth)
    text +=
        fmt::format("{},{:.2f},{:.2f},{:.2f},{:.2f},{:.2f},{:.2f},{:.1f},{:.1f},{:.0f}\n", one.fdi,
                    one.crown_L.x(), one.crown_L.y(), one.crown_L.z(), one.apex_L.x(),
                    one.apex_L.y(), one.apex_L.z(), one.length_mm, one.width_mm, one.volume_mm3);
  return text;
}

Summary summary_of(const dental::NumberedTeeth& found, const std::filesystem::path& output) {
  Summary summary;
  summary.text = fmt::format("{}: {} teeth:", output.string(), found.teeth.size());
  nlohmann::json teeth = nlohmann::json::array();
  for (const dental::NumberedTooth& one : found.teeth) {
    summary.text += fmt::format(" {}", one.fdi);
    teeth.push_back(tooth_json(one));
  }
  if (!found.missing.empty()) {
    summary.text += "\n  not found:";
    for (const int fdi : found.missing) summary.text += fmt::format(" {}", fdi);
  }
  summary.text += fmt::format("\n  check the numbers in a viewer\n{}", kNotForClinicalUse);
  summary.json = {{"lefort_teeth", 1},
                  {"notice", kNotForClinicalUse},
                  {"teeth", teeth},
                  {"missing", found.missing}};
  return summary;
}

plan::Landmarks points_of(const std::vector<dental::NumberedTooth>& teeth) {
  plan::Landmarks points;
  for (const dental::NumberedTooth& one : teeth) {
    points.push_back({fmt::format("{}", one.fdi), one.crown_L});
    points.push_back({fmt::format("{} apex", one.fdi), one.apex_L});
  }
  return points;
}

}  // namespace

Result<Summary> number_teeth_of_scan(const TeethJob& job, Progress& progress) {
  const std::array<std::string, 5> needed{"N", "Or-R", "Or-L", "Po-R", "Po-L"};
  const std::array<std::filesystem::path, 1> written{job.output / "teeth.mrk.json"};
  LEFORT_TRY(std::vector<dental::ToothCorrection> corrections,
             read_tooth_corrections(job.corrections));
  for (const dental::ToothCorrection& more : job.more_corrections) {
    std::erase_if(corrections, [&](const auto& one) { return one.found == more.found; });
    corrections.push_back(more);
  }
  if (job.landmarks) LEFORT_TRY_VOID(io::check_inputs_are_distinct({&*job.landmarks, 1}, written));
  LEFORT_TRY(const OrientedHead head,
             oriented_head({job.ct, job.labels, job.landmarks}, needed, progress));
  progress.begin_stage("number the teeth");
  const anatomy::ToothMap teeth =
      anatomy::find_teeth(head.scanned.scan.ct, head.scanned.labels, head.scanned.levels.bone_hu);
  auto numbered = dental_numbers(teeth, head.landmarks);
  if (!numbered)
    return fail(ErrorCode::kAnatomyMissing,
                "no landmark of the mid-sagittal plane (N, ANS, A): give one in a file "
                "(--landmarks)");
  if (numbered->teeth.empty())
    return fail(
        ErrorCode::kAnatomyMissing,
        "no teeth are found: both jaws must be in the scan and in the labels, and the teeth "
        "must show enamel");
  LEFORT_TRY(const dental::NumberedTeeth found,
             dental::renumbered(*std::move(numbered), corrections));
  LEFORT_TRY_VOID(io::make_output_folder(job.output));
  const std::filesystem::path file = job.output / "teeth_corrections.json";
  if (corrections.empty()) {
    LEFORT_TRY_VOID(io::remove_earlier_files({&file, 1}));
  } else {
    LEFORT_TRY_VOID(write_tooth_corrections(file, corrections));
  }
  LEFORT_TRY_VOID(io::write_numbered_teeth(job.output / "teeth_numbered.seg.nrrd", found.numbers));
  LEFORT_TRY_VOID(io::write_landmarks(job.output / "teeth.mrk.json", points_of(found.teeth)));
  LEFORT_TRY_VOID(io::write_text(job.output / "teeth.csv", teeth_csv(found.teeth)));
  Summary summary = summary_of(found, job.output);
  LEFORT_TRY_VOID(io::write_text(job.output / "teeth.json", summary.json.dump(1) + "\n"));
  return summary;
}

}  // namespace lefort::pipeline
