#include <lefort/contact/project_contact_to_bone.h>
#include <lefort/core/units.h>
#include <lefort/geometry/transform_mesh.h>
#include <lefort/io/output_folder.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/vtu.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/predict/write_prediction.h>
#include <lefort/pipeline/prepare/interface_surface.h>
#include <lefort/predict/embed_skin.h>
#include <lefort/predict/tissue_boundary.h>
#include <lefort/report/mesh_plots.h>
#include <lefort/report/report_html.h>

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string>
#include <system_error>
#include <vector>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPictures = "pictures";
constexpr const char* kParaview = "paraview";

std::string as_text(const nlohmann::ordered_json& json) {
  return json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

/// Files in `folder` that an earlier prediction may have written.
std::vector<fs::path> earlier_files(const fs::path& folder, std::string_view beginning,
                                    std::string_view ending) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name.starts_with(beginning) && name.ends_with(ending)) files.push_back(entry->path());
  }
  return files;
}

/// Bone at its pose, with the contact fields of the tissue.
Result<void> write_moved_segment(const fs::path& file, const PreparedCase& prepared,
                                 const predict::FacePrediction& prediction, std::size_t segment) {
  const predict::PredictionStep& last = prediction.steps.back();
  const auto& [X_LB, contact, supports] = last.segments[segment];
  static_cast<void>(supports);
  const geometry::TriangleMesh segment_L =
      geometry::transformed(prepared.cut.segments_L[segment], X_LB);
  if (prediction.nodal_contacts.empty()) return io::write_surface(file, segment_L);
  const mesh::VolumeMesh& tissue = prepared.model.tissue;
  std::vector<Vec3> x_L = tissue.nodes_L;
  for (std::size_t n = 0; n < x_L.size(); ++n) x_L[n] += last.displacement_mm[n];
  // Tissue initially within contact_snap_mm of the bone is in contact.
  const double near_mm =
      prepared.plan.boundary.contact_snap_mm + contact.max_penetration_increase_mm;
  contact::BoneContactFields load =
      contact::project_contact_to_bone(segment_L, x_L, tissue.face_sets.at(predict::sets::kContact),
                                       prediction.nodal_contacts[segment], near_mm);
  for (double& pressure : load.pressure_mpa) pressure = kpa_from_mpa(pressure);
  return io::write_surface(
      file, segment_L,
      {{"contact_pressure_kpa", load.pressure_mpa}, {"contact_depth_mm", load.depth_mm}});
}

}  // namespace

Result<void> remove_results(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const char* name : {"prediction.json", "failure.json", "report.html", "plan.json",
                           "predicted_skin.vtp", "predicted_skin.stl", "skin_before.vtp",
                           "bone_remainder.vtp", "timing.json", kInterfaceFile})
    files.push_back(folder / name);
  for (const char* bone : {kMovedSegment, kBoneOverlap})
    for (const fs::path& file : earlier_files(folder, bone, ".vtp")) files.push_back(file);
  files.push_back(folder / kParaview / "prediction.pvd");
  for (const fs::path& step : earlier_files(folder / kParaview, "step_", ".vtu"))
    files.push_back(step);
  for (const char* kind : {"before_", "after_", "displacement_", "bones_"})
    for (const fs::path& picture : earlier_files(folder / kPictures, kind, ".png"))
      files.push_back(picture);
  for (const fs::path& plot : earlier_files(folder / kPictures, "mesh_", ".svg"))
    files.push_back(plot);
  return io::remove_earlier_files(files);
}

std::string segment_file(std::string_view name, const io::PlanFile& plan, std::size_t segment) {
  if (plan.segments.size() == 1) return fmt::format("{}.vtp", name);
  return fmt::format("{}_{}.vtp", name, plan.segments[segment].osteotomy.segment);
}

Result<void> write_overlaps(const fs::path& folder, const PreparedCase& prepared) {
  for (std::size_t k = 0; k < prepared.plan.segments.size(); ++k) {
    const std::string& name = prepared.plan.segments[k].osteotomy.segment;
    std::map<double, std::vector<double>> deepest_mm;  // Of each vertex, for each path fraction.
    for (const predict::BoneOverlapAtFraction& pair : prepared.overlaps) {
      const bool is_first = pair.first == name;
      if (!pair.overlap.overlaps() || (!is_first && pair.second != name)) continue;
      const std::vector<double>& depth_mm =
          is_first ? pair.overlap.depth_mm : pair.overlap.depth_of_second_mm;
      std::vector<double>& all_mm =
          deepest_mm.try_emplace(pair.path_fraction, depth_mm).first->second;
      for (std::size_t v = 0; v < all_mm.size(); ++v) all_mm[v] = std::max(all_mm[v], depth_mm[v]);
    }
    if (deepest_mm.empty()) continue;
    std::vector<io::VertexArray> arrays;
    for (auto& [path_fraction, depth_mm] : deepest_mm)
      arrays.push_back({fmt::format("overlap_mm_at_{:.4f}", path_fraction), std::move(depth_mm)});
    LEFORT_TRY_VOID(io::write_surface(folder / segment_file(kBoneOverlap, prepared.plan, k),
                                      prepared.cut.segments_L[k], arrays));
  }
  return {};
}

Result<void> write_surfaces_and_fields(const fs::path& folder, const PreparedCase& prepared,
                                       const predict::FacePrediction& prediction,
                                       std::span<const Vec3> skin_displacement_mm) {
  const geometry::TriangleMesh after_L = predict::displaced(prepared.skin_L, skin_displacement_mm);
  const std::vector<Vec3> shift(skin_displacement_mm.begin(), skin_displacement_mm.end());
  LEFORT_TRY_VOID(
      io::write_surface(folder / "predicted_skin.vtp", after_L, {{"displacement_mm", shift}}));
  LEFORT_TRY_VOID(io::write_surface(folder / "predicted_skin.stl", after_L));
  LEFORT_TRY_VOID(io::write_surface(folder / "skin_before.vtp", prepared.skin_L));
  LEFORT_TRY_VOID(io::write_surface(folder / "bone_remainder.vtp", prepared.cut.remainder_L));
  LEFORT_TRY_VOID(write_interface_surface(folder / kInterfaceFile, prepared.model));
  for (std::size_t k = 0; k < prepared.plan.segments.size(); ++k)
    LEFORT_TRY_VOID(write_moved_segment(folder / segment_file(kMovedSegment, prepared.plan, k),
                                        prepared, prediction, k));
  return {};
}

Result<void> write_paraview(const fs::path& output, const PreparedCase& prepared,
                            const predict::FacePrediction& prediction) {
  const fs::path folder = output / kParaview;
  LEFORT_TRY_VOID(io::make_output_folder(folder));
  const mesh::VolumeMesh& tissue = prepared.model.tissue;
  std::vector<io::PvdEntry> series;
  const auto write = [&](double path_fraction,
                         const std::vector<Vec3>& displacement_mm) -> Result<void> {
    const std::string file = fmt::format("step_{:04d}.vtu", series.size());
    io::VtuFields fields;
    fields.nodes.push_back(io::vtu_array("displacement_mm", displacement_mm));
    LEFORT_TRY_VOID(io::write_vtu(folder / file, tissue, fields));
    series.push_back({path_fraction, file});
    return {};
  };
  LEFORT_TRY_VOID(write(0.0, std::vector<Vec3>(tissue.nodes_L.size(), Vec3::Zero())));
  for (const predict::PredictionStep& step : prediction.steps)
    LEFORT_TRY_VOID(write(step.path_fraction, step.displacement_mm));
  return io::write_pvd(folder / "prediction.pvd", series);
}

Result<void> write_documents(const fs::path& folder, const report::CaseReport& report,
                             std::span<const PredictionPicture> pictures,
                             const mesh::MeshQuality& quality, std::string_view plan_text,
                             const nlohmann::ordered_json& prediction) {
  if (!pictures.empty()) {
    LEFORT_TRY_VOID(io::make_output_folder(folder / kPictures));
    for (const auto& [name, svg] : report::mesh_plots(quality))
      LEFORT_TRY_VOID(io::write_text(folder / kPictures / name, svg));
  }
  for (const PredictionPicture& picture : pictures)
    LEFORT_TRY_VOID(io::write_text(folder / kPictures / picture.file, picture.png));
  LEFORT_TRY_VOID(io::write_text(folder / "report.html", report::report_html(report)));
  LEFORT_TRY_VOID(io::write_text(folder / "plan.json", plan_text));
  return io::write_text(folder / "prediction.json", as_text(prediction));
}

Result<void> write_failure(const fs::path& folder, const report::CaseReport& report,
                           std::string_view plan_text, const nlohmann::ordered_json& failure) {
  LEFORT_TRY_VOID(io::write_text(folder / "report.html", report::report_html(report)));
  LEFORT_TRY_VOID(io::write_text(folder / "plan.json", plan_text));
  return io::write_text(folder / "failure.json", as_text(failure));
}

}  // namespace lefort::pipeline
