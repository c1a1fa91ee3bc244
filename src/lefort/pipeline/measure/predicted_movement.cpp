#include <lefort/io/predicted_poses.h>
#include <lefort/io/read_text.h>
#include <lefort/io/read_vtu.h>
#include <lefort/io/surface_files.h>
#include <lefort/pipeline/measure/predicted_movement.h>

#include <fmt/format.h>

#include <cstdint>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxPrediction = 256 << 20;  // Bytes.

tl::unexpected<Error> damaged_prediction(const fs::path& folder) {
  return fail(ErrorCode::kFileCorrupt,
              fmt::format("{} is damaged: predict again", (folder / "prediction.json").string()));
}

/// Adds the vertices of a bone that has moved.
Result<void> add_bone(const fs::path& file, const RigidTransform& X_LB, Progress& progress,
                      PredictedMovement& movement) {
  LEFORT_TRY(const geometry::TriangleMesh after_L, io::read_surface(file, progress));
  const RigidTransform X_BL = X_LB.inverse();
  for (const Vec3& q_L : after_L.vertices)
    movement.points.push_back({X_BL * q_L, q_L - X_BL * q_L});
  return {};
}

Result<void> add_tissue(const fs::path& folder, std::size_t step, Progress& progress,
                        PredictedMovement& movement) {
  const auto file = [&](std::size_t n) {
    return folder / "paraview" / fmt::format("step_{:04d}.vtu", n);
  };
  LEFORT_TRY(mesh::VolumeMesh tissue, io::read_vtu(file(0), {}, progress));
  LEFORT_TRY(const std::vector<Vec3> shifts, io::read_vtu_vectors(file(step), "displacement_mm"));
  if (shifts.size() != tissue.nodes_L.size()) return damaged_prediction(folder);
  for (std::size_t n = 0; n < shifts.size(); ++n)
    movement.points.push_back({tissue.nodes_L[n], shifts[n]});
  movement.tissue_L = std::move(tissue.nodes_L);
  return {};
}

}  // namespace

Result<PredictedMovement> predicted_movement(const fs::path& folder, Progress& progress) {
  LEFORT_TRY(const std::string text, io::read_text(folder / "prediction.json", kMaxPrediction));
  const auto json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_object() || !json.contains("steps") || !json["steps"].is_array() ||
      json["steps"].empty())
    return damaged_prediction(folder);
  LEFORT_TRY(const auto poses, io::predicted_poses(json, json["steps"].back()));
  PredictedMovement movement;
  if (const auto inputs = json.find("inputs"); inputs != json.end() && inputs->is_object())
    if (const auto sha = inputs->find("ct_sha256"); sha != inputs->end() && sha->is_string())
      movement.ct_sha256 = sha->get<std::string>();
  LEFORT_TRY_VOID(add_tissue(folder, json["steps"].size(), progress, movement));
  for (const io::SegmentPose& one : poses) {
    const std::string name = poses.size() == 1
                                 ? std::string("bone_segment_moved.vtp")
                                 : fmt::format("bone_segment_moved_{}.vtp", one.segment);
    LEFORT_TRY_VOID(add_bone(folder / name, one.X_LB, progress, movement));
  }
  LEFORT_TRY_VOID(
      add_bone(folder / "bone_remainder.vtp", RigidTransform::Identity(), progress, movement));
  return movement;
}

}  // namespace lefort::pipeline
