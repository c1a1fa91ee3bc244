#include <lefort/anatomy/histogram_thresholds.h>
#include <lefort/image/find_padding.h>
#include <lefort/io/internal/hounsfield.h>

#include <fmt/format.h>

#include <algorithm>

namespace lefort::io {

namespace {

/// Air around the head is near -1000 HU; fewer such voxels are suspicious.
constexpr std::int16_t kSurelyAir = -500;

/// Min density of the patient, as the default of the segmentation.
constexpr double kTissueHu = -300.0;

/// Smaller scans do not contain a head.
constexpr double kMinHead_ml = 500.0;

/// Range of the means of air and of soft tissue in scans in HU: air in the airway is blurred, and
/// soft tissue includes fat and partial volume of bone.
constexpr double kAirFromHu = -1100.0, kAirToHu = -880.0;
constexpr double kSoftFromHu = -150.0, kSoftToHu = 180.0;

/// A smaller abrupt end may be noise in single voxels.
constexpr double kMinCut_mm2 = 100.0;

}  // namespace

std::vector<std::string> hounsfield_warnings(const HounsfieldCount& count,
                                             const image::CtVolume& ct) {
  std::vector<std::string> warnings;
  if (count.beyond_range > 0)
    warnings.push_back(
        fmt::format("{} of {} voxels were outside {} to {} HU and were set to the limit",
                    count.beyond_range, ct.values.size(), kLowestHu, kHighestHu));
  if (count.not_a_number > 0)
    warnings.push_back(fmt::format("{} of {} voxels were not numbers and were set to air",
                                   count.not_a_number, ct.values.size()));
  const auto [lowest, highest] = std::minmax_element(ct.values.begin(), ct.values.end());
  if (lowest != ct.values.end() && *lowest > kSurelyAir)
    warnings.push_back(fmt::format(
        "the values range from {} to {}, expected air near -1000: they may not be in HU", *lowest,
        *highest));
  else if (static_cast<double>(ct.grid.voxel_count()) * ct.grid.spacing_mm.prod() >
           kMinHead_ml * 1e3) {
    if (const auto found = anatomy::find_thresholds(ct);
        found && (found->air_mean_hu < kAirFromHu || found->air_mean_hu > kAirToHu ||
                  found->soft_mean_hu < kSoftFromHu || found->soft_mean_hu > kSoftToHu))
      warnings.push_back(fmt::format(
          "air is near {:.0f} and soft tissue near {:.0f}, expected about -1000 and 40: the values "
          "are not exactly HU, so segment with thresholds from the histogram",
          found->air_mean_hu, found->soft_mean_hu));
  }
  if (const image::Padding padding = image::find_padding(ct, kTissueHu);
      padding.truncated_mm2 > kMinCut_mm2)
    warnings.push_back(
        fmt::format("the field of view is surrounded by {} HU and ends in tissue over {:.2g} cm2, "
                    "where its boundary is mistaken for skin",
                    padding.hu, padding.truncated_mm2 * 1e-2));
  return warnings;
}

}  // namespace lefort::io
