#include <lefort/anatomy/intraoral_scan.h>
#include <lefort/core/units.h>
#include <lefort/geometry/transform_mesh.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/json/json_values.h>
#include <lefort/pipeline/scan/dentition_files.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cstdint>
#include <utility>

namespace lefort::pipeline {
namespace {

constexpr double kScanSpacing_mm = 0.25, kScanNoise_mm = 0.03;

/// The frame of an intraoral scanner: any, but always the same.
RigidTransform scanner_frame(const Vec3& axis, double angle_deg, const Vec3& translation_mm) {
  RigidTransform X = RigidTransform::Identity();
  X.linear() =
      Eigen::AngleAxisd(radians_from_degrees(angle_deg), axis.normalized()).toRotationMatrix();
  X.translation() = translation_mm;
  return X;
}

nlohmann::json point_json(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

nlohmann::json truth_of(const anatomy::ParametricHead& head) {
  nlohmann::json teeth = nlohmann::json::array();
  for (const anatomy::ToothForm& tooth : head.dentition().teeth()) {
    const Vec3 apex_M = tooth.origin_M - tooth.root_mm * tooth.axes_M.col(2);
    teeth.push_back({{"fdi", tooth.fdi},
                     {"crown_mm", point_json(head.from_tooth_L(tooth, tooth.crown_M()))},
                     {"tip_mm", point_json(head.from_tooth_L(tooth, tooth.tip_M()))},
                     {"apex_mm", point_json(head.from_tooth_L(tooth, apex_M))}});
  }
  nlohmann::json canals;
  for (const double side : {-1.0, 1.0}) {
    nlohmann::json line = nlohmann::json::array();
    for (const Vec3& p_L : head.canal_L(side)) line.push_back(point_json(p_L));
    canals[side < 0.0 ? "right" : "left"] = std::move(line);
  }
  return {{"lefort_phantom_truth", 1},
          {"frame", "LPS of the CT, mm"},
          {"lower_to_occlusion_4x4_row_major_mm_lps", as_json(head.X_occlusion_L())},
          {"opening_deg", degrees_from_radians(head.shape().opening_rad)},
          {"teeth", std::move(teeth)},
          {"canals_mm", std::move(canals)}};
}

}  // namespace

Result<void> write_dentition_files(const anatomy::ParametricHead& head,
                                   const std::filesystem::path& folder, Progress& progress) {
  nlohmann::json truth = truth_of(head);
  progress.begin_stage("scan the teeth");
  const auto arch = [&](bool is_upper, std::uint64_t seed) {
    return anatomy::scanned_arch(head, is_upper, kScanSpacing_mm, kScanNoise_mm, seed, progress);
  };
  LEFORT_TRY(const auto upper_L, arch(true, 11));
  LEFORT_TRY(const auto lower_L, arch(false, 12));
  LEFORT_TRY(const auto upper_again_L, arch(true, 13));  // The bite has noise of its own.
  LEFORT_TRY(const auto lower_again_L, arch(false, 14));
  const geometry::TriangleMesh bite_L = anatomy::scanned_bite(head, upper_again_L, lower_again_L);
  struct Scan {
    const char* name;
    const geometry::TriangleMesh& mesh_L;
    RigidTransform X_scan_L;
  };
  const Scan scans[] = {{"upper", upper_L, scanner_frame({1, 2, -1}, 130.0, {20, -45, 12})},
                        {"lower", lower_L, scanner_frame({-2, 1, 1}, 75.0, {-8, 31, 60})},
                        {"bite", bite_L, scanner_frame({1, -1, 3}, -100.0, {55, 4, -27})}};
  for (const auto& [name, mesh_L, X_scan_L] : scans) {
    LEFORT_TRY_VOID(io::write_surface(folder / fmt::format("{}_scan.stl", name),
                                      geometry::transformed(mesh_L, X_scan_L)));
    truth[fmt::format("{}_scan_to_ct_4x4_row_major_mm_lps", name)] = as_json(X_scan_L.inverse());
  }
  return io::write_text(folder / "truth.json", truth.dump(2) + "\n");
}

}  // namespace lefort::pipeline
