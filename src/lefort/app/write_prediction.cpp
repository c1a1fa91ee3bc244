#include <lefort/app/output_folder.h>
#include <lefort/app/write_prediction.h>
#include <lefort/geometry/transform_mesh.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/vtu.h>
#include <lefort/io/write_atomically.h>
#include <lefort/predict/move_skin.h>
#include <lefort/report/report_html.h>

#include <fmt/format.h>

#include <string>
#include <system_error>
#include <vector>

namespace lefort::app {
namespace {

namespace fs = std::filesystem;

Result<void> write_paraview(const fs::path& folder, const PreparedCase& prepared,
                            const predict::FacePrediction& prediction) {
  LEFORT_TRY_VOID(make_output_folder(folder));
  const mesh::VolumeMesh& tissue = prepared.model.tissue;
  std::vector<io::PvdEntry> series;
  const auto write = [&](double share, const std::vector<Vec3>& displacement_mm) -> Result<void> {
    const std::string file = fmt::format("step_{:04d}.vtu", series.size());
    io::VtuFields fields;
    fields.nodes.push_back(io::vtu_array("displacement_mm", displacement_mm));
    LEFORT_TRY_VOID(io::write_vtu(folder / file, tissue, fields));
    series.push_back({share, file});
    return {};
  };
  LEFORT_TRY_VOID(write(0.0, std::vector<Vec3>(tissue.nodes_L.size(), Vec3::Zero())));
  for (const predict::PredictionStep& step : prediction.steps)
    LEFORT_TRY_VOID(write(step.share, step.displacement_mm));
  return io::write_pvd(folder / "prediction.pvd", series);
}

}  // namespace

Result<void> write_surfaces_and_fields(const fs::path& folder, const PreparedCase& prepared,
                                       const predict::FacePrediction& prediction,
                                       std::span<const Vec3> skin_displacement_mm) {
  const geometry::TriangleMesh after_L = predict::displaced(prepared.skin_L, skin_displacement_mm);
  const std::vector<Vec3> shift(skin_displacement_mm.begin(), skin_displacement_mm.end());
  LEFORT_TRY_VOID(
      io::write_surface(folder / "predicted_skin.vtp", after_L, {{"displacement_mm", shift}}));
  LEFORT_TRY_VOID(io::write_surface(folder / "predicted_skin.stl", after_L));
  LEFORT_TRY_VOID(io::write_surface(folder / "skin_before.vtp", prepared.skin_L));
  LEFORT_TRY_VOID(io::write_surface(folder / "bone_remainder.vtp", prepared.bones.remainder_L));
  LEFORT_TRY_VOID(io::write_surface(
      folder / "bone_segment_moved.vtp",
      geometry::transformed(prepared.bones.segment_L, prediction.steps.back().X_LB)));
  return write_paraview(folder / "paraview", prepared, prediction);
}

Result<void> write_documents(const fs::path& folder, const report::CaseReport& report,
                             std::span<const PredictionPicture> pictures,
                             const nlohmann::ordered_json& prediction) {
  if (!pictures.empty()) LEFORT_TRY_VOID(make_output_folder(folder / "pictures"));
  for (const PredictionPicture& picture : pictures)
    LEFORT_TRY_VOID(io::write_text(folder / "pictures" / picture.file, picture.png));
  LEFORT_TRY_VOID(io::write_text(folder / "report.html", report::report_html(report)));
  std::error_code ignored;
  fs::remove(folder / "failure.json", ignored);  // Of an earlier run that this one replaces.
  return io::write_text(folder / "prediction.json", prediction.dump(1) + "\n");
}

}  // namespace lefort::app
