#include <lefort/io/field_file.h>
#include <lefort/pipeline/cache/stage_keys.h>
#include <lefort/pipeline/prepare/cached_field.h>
#include <lefort/predict/contact_field.h>

#include <utility>

namespace lefort::pipeline {

namespace fs = std::filesystem;

field::DistanceFieldOptions contact_field_options(const io::PlanFile& plan,
                                                  const geometry::TriangleMesh& surface_B) {
  field::DistanceFieldOptions options =
      predict::contact_field_options(plan.field, surface_B, plan.tissue, plan.contact.obstacle);
  options.smooth = plan.contact.detection == contact::DetectionMethod::kSmooth;
  return options;
}

field::DistanceFieldOptions bone_field_options(const io::PlanFile& plan,
                                               const geometry::TriangleMesh& surface_B) {
  field::DistanceFieldOptions options = contact_field_options(plan, surface_B);
  if (plan.contact.obstacle != predict::Obstacle::kBone &&
      plan.boundary.interface != predict::TissueInterface::kBonded)
    options.smooth = false;
  return options;
}

Result<std::shared_ptr<const field::DistanceField>> find_field(
    const std::string& name, const geometry::TriangleMesh& surface_B,
    const field::DistanceFieldOptions& options, const StageCache& cache, Progress& progress) {
  progress.begin_stage(name + "'s distance field");
  LEFORT_TRY(field::DistanceField field,
             cache.get(
                 name + ".field", field_key(surface_B, options), progress,
                 [](const fs::path& path) { return io::read_field(path); },
                 [&] { return field::build_distance_field(surface_B, options, progress); },
                 [](const fs::path& path, const field::DistanceField& made) {
                   return io::write_field(path, made);
                 }));
  return std::make_shared<const field::DistanceField>(std::move(field));
}

fs::path field_file(const std::string& name, const geometry::TriangleMesh& surface_B,
                    const field::DistanceFieldOptions& options, const StageCache& cache) {
  return cache.file(name + ".field", field_key(surface_B, options));
}

}  // namespace lefort::pipeline
