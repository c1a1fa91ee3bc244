#include <lefort/io/read_text.h>
#include <lefort/io/read_vtu.h>
#include <lefort/io/step_skin.h>
#include <lefort/io/surface_files.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <string>

namespace lefort::io {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxDocument = 256 << 20;  // Bytes.

fs::path step_file(const fs::path& folder, int step) {
  return folder / "paraview" / fmt::format("step_{:04d}.vtu", step);
}

}  // namespace

Result<StepSkin> StepSkin::read(const fs::path& folder, const Vec3& spacing_mm) {
  LEFORT_TRY(const std::string text, read_text(folder / "prediction.json", kMaxDocument));
  const auto json = nlohmann::json::parse(text, nullptr, false);
  predict::TissueOptions tissue;
  try {
    tissue.element_size_mm = json.at("parameters").at("element_size_mm").get<double>();
  } catch (const nlohmann::json::exception&) {
    return fail(ErrorCode::kFileCorrupt, "prediction.json is damaged: predict again");
  }
  LEFORT_TRY(const geometry::TriangleMesh skin_L, read_surface(folder / "skin_before.vtp"));
  LEFORT_TRY(const mesh::VolumeMesh mesh, read_vtu(step_file(folder, 0)));
  StepSkin skin;
  skin.folder_ = folder;
  skin.binding_ =
      predict::embed_skin(skin_L, mesh, predict::embedding_distance_mm(tissue, spacing_mm));
  skin.nodes_ = mesh.node_count();
  return skin;
}

Result<std::vector<Vec3>> StepSkin::displacement_mm(int step) const {
  LEFORT_TRY(const std::vector<Vec3> tissue_mm,
             read_vtu_vectors(step_file(folder_, step), "displacement_mm"));
  if (Index(tissue_mm.size()) != nodes_)
    return fail(ErrorCode::kFileCorrupt, fmt::format("step {} has another mesh", step));
  return predict::skin_displacement(binding_, tissue_mm);
}

}  // namespace lefort::io
