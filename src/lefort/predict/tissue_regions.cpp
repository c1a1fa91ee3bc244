#include <lefort/predict/assign_regions.h>
#include <lefort/predict/tissue_regions.h>

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace lefort::predict {

Result<void> check_muscle_labels(const TissueOptions& options, const anatomy::LabelMap& labels) {
  const bool is_there = std::find(labels.values.begin(), labels.values.end(),
                                  anatomy::Tissue::kMuscle) != labels.values.end();
  if (!options.muscle || is_there) return {};
  return fail(ErrorCode::kPlanInvalid,
              "tissue.muscle: no voxel of the labels is muscle; paint a segment called muscle and "
              "name its file as segmentation.labels");
}

mesh::VolumeMesh assign_tissue_regions(mesh::VolumeMesh tissue, const TissueOptions& options,
                                       const anatomy::LabelMap& labels, Progress& progress) {
  if (!options.muscle && !options.mucosa) return tissue;
  if (options.muscle) tissue = assign_muscle(std::move(tissue), labels);
  if (options.mucosa)
    tissue = assign_mucosa(std::move(tissue), labels, options.mucosa->thickness_mm);
  progress.note(describe_regions(tissue, options));
  for (const auto& [name, size] : regions_and_sizes(tissue, options))
    if (size.elements == 0)
      progress.note(fmt::format("warning: tissue.{} has no effect: no element is {}", name, name));
  return tissue;
}

}  // namespace lefort::predict
