#include <lefort/anatomy/find_air_spaces.h>
#include <lefort/anatomy/find_brain.h>
#include <lefort/anatomy/find_mandible.h>
#include <lefort/anatomy/find_outside.h>
#include <lefort/anatomy/find_patient.h>
#include <lefort/anatomy/partial_volume_air.h>
#include <lefort/anatomy/segment_tissue.h>
#include <lefort/anatomy/sharpen_bone.h>

#include <fmt/format.h>

#include <algorithm>
#include <string>

namespace lefort::anatomy {
namespace {

// Min volume of the air, bone and skin of a head; less is noise.
constexpr double kMinTissue_ml = 1.0;
// Peak memory of the segmentation; measured, see test_segment_tissue.cpp.
constexpr double kBytesPerVoxel = 40.0;

Result<void> check_options(const SegmentationOptions& options) {
  // Written so that NaN fails.
  if (!(options.bone_hu > options.skin_hu))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("bone_hu is {} and skin_hu {}, bone must be denser than skin",
                            options.bone_hu, options.skin_hu));
  const auto check = [](const char* name, double value, bool valid,
                        const char* range) -> Result<void> {
    if (valid && value < 1e6) return {};
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{} is {}, must be {}", name, value, range));
  };
  LEFORT_TRY_VOID(check("min_bone_ml", options.min_bone_ml, options.min_bone_ml >= 0.0, ">= 0"));
  LEFORT_TRY_VOID(check("nostril_radius_mm", options.nostril_radius_mm,
                        options.nostril_radius_mm > 0.0 && options.nostril_radius_mm <= 50.0,
                        "> 0 and <= 50"));
  LEFORT_TRY_VOID(
      check("ostium_radius_mm", options.ostium_radius_mm, options.ostium_radius_mm > 0.0, "> 0"));
  LEFORT_TRY_VOID(
      check("max_memory_gib", options.max_memory_gib, options.max_memory_gib > 0.0, "> 0"));
  return check("min_air_ml", options.min_air_ml, options.min_air_ml >= 0.0, ">= 0");
}

Result<void> check_scan(const image::CtVolume& ct, double max_memory_gib) {
  const image::Grid& grid = ct.grid;
  const auto [minimum, maximum] = std::minmax_element(grid.size.begin(), grid.size.end());
  if (*minimum < 0 || *maximum > 100'000 || grid.voxel_count() != Index(ct.values.size()))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("scan has {} values, which must match its grid of {} x {} x {} voxels",
                            ct.values.size(), grid.size[0], grid.size[1], grid.size[2]));
  if (!(grid.spacing_mm.minCoeff() > 0.0) || !(grid.spacing_mm.maxCoeff() < 1e3))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("voxel spacing is {} x {} x {} mm, must be positive",
                            grid.spacing_mm[0], grid.spacing_mm[1], grid.spacing_mm[2]));
  if (ct.values.empty())
    return fail(ErrorCode::kAnatomyMissing, "scan is empty, a head was expected");
  const double needed_gib = kBytesPerVoxel * double(grid.voxel_count()) / double(1 << 30);
  if (needed_gib > max_memory_gib)
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("scan has {} x {} x {} voxels and needs {:.3g} GiB of memory, the limit "
                    "is {:.3g} GiB: crop it to the head, or merge slices",
                    grid.size[0], grid.size[1], grid.size[2], needed_gib, max_memory_gib));
  const auto [lowest, highest] = std::minmax_element(ct.values.begin(), ct.values.end());
  if (*lowest == *highest)
    return fail(ErrorCode::kAnatomyMissing,
                fmt::format("scan is {} HU everywhere, a head was expected", *lowest));
  return {};
}

Result<void> check_found(const char* what, const Mask& found, const std::string& criterion) {
  const double ml = double(voxel_count(found)) * voxel_ml(found.grid);
  if (ml >= kMinTissue_ml) return {};
  return fail(ErrorCode::kAnatomyMissing,
              fmt::format("scan shows {:.2f} ml of {} ({}), expected at least {} ml", ml, what,
                          criterion, kMinTissue_ml));
}

/// Extends airway and sinuses to bare bone, but not through a wall to other air.
void add_air_at_bone(const image::CtVolume& ct, const Mask& bone, const Mask& outside,
                     AirSpaces& air) {
  const Mask by_airway = partial_volume_air(ct, air.airway, bone);
  const Mask by_sinus = partial_volume_air(ct, air.sinus, bone);
  for (std::size_t v = 0; v < ct.values.size(); ++v) {
    if (outside.values[v] != 0 || by_airway.values[v] == by_sinus.values[v]) continue;
    if (by_airway.values[v] != 0 && air.sinus.values[v] == 0) air.airway.values[v] = 1;
    if (by_sinus.values[v] != 0 && air.airway.values[v] == 0) air.sinus.values[v] = 1;
  }
}

/// Reports progress and checks for cancellation.
class Steps {
 public:
  Steps(Progress& progress, int count) : progress_(progress), count_(count) {
    progress_.begin_stage("segment tissues");
  }
  [[nodiscard]] Result<void> next() {
    progress_.report(double(done_++) / count_);
    if (progress_.stop_requested())
      return fail(ErrorCode::kCancelled, "segmentation was cancelled");
    return {};
  }

 private:
  Progress& progress_;
  int count_;
  int done_ = 0;
};

}  // namespace

Result<LabelMap> segment_tissue(const image::CtVolume& ct, const SegmentationOptions& options,
                                Progress& progress) {
  LEFORT_TRY_VOID(check_options(options));
  LEFORT_TRY_VOID(check_scan(ct, options.max_memory_gib));
  const image::Grid& grid = ct.grid;
  Steps steps(progress, 6);

  LEFORT_TRY_VOID(steps.next());
  const Mask patient = find_patient(ct, options.skin_hu);
  LEFORT_TRY_VOID(check_found("tissue", patient, fmt::format("at least {} HU", options.skin_hu)));

  LEFORT_TRY_VOID(steps.next());
  const Mask bone = find_bone(ct, patient, options);
  LEFORT_TRY_VOID(check_found("bone", bone, fmt::format("at least {} HU", options.bone_hu)));

  LEFORT_TRY_VOID(steps.next());
  const Mask outside = find_outside(patient, options.nostril_radius_mm);
  LEFORT_TRY_VOID(check_found("air around the patient", outside,
                              fmt::format("below {} HU, the threshold of skin", options.skin_hu)));

  LEFORT_TRY_VOID(steps.next());
  const Mask inner_air = mask_where(
      grid, [&](std::size_t v) { return patient.values[v] == 0 && outside.values[v] == 0; });
  AirSpaces air = find_air_spaces(inner_air, bone, outside, options);
  // After the division into rooms, which needs thin walls between them.
  add_air_at_bone(ct, bone, outside, air);

  LEFORT_TRY_VOID(steps.next());
  const Mask soft = mask_where(grid, [&](std::size_t v) {
    return outside.values[v] == 0 && bone.values[v] == 0 && air.airway.values[v] == 0 &&
           air.sinus.values[v] == 0;
  });
  const Mask brain = find_brain(soft, bone, outside);

  LEFORT_TRY_VOID(steps.next());
  const Mask mandible = find_mandible(ct, bone, options.bone_hu);

  LabelMap labels{grid, std::vector<Tissue>(ct.values.size(), Tissue::kBackground)};
  const auto mark = [&](const Mask& mask, Tissue tissue) {
    for (std::size_t v = 0; v < mask.values.size(); ++v)
      if (mask.values[v] != 0) labels.values[v] = tissue;
  };
  mark(soft, Tissue::kSoftTissue);
  mark(brain, Tissue::kBrain);
  mark(bone, Tissue::kBone);
  mark(mandible, Tissue::kMandible);
  mark(air.airway, Tissue::kAirway);
  mark(air.sinus, Tissue::kSinus);
  // Without the mandible the threshold alone decides.
  if (voxel_count(mandible) > 0) sharpen_bone(ct, labels);
  progress.report(1.0);
  return labels;
}

}  // namespace lefort::anatomy
