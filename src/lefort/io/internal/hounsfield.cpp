#include <lefort/anatomy/histogram_thresholds.h>
#include <lefort/image/find_padding.h>
#include <lefort/io/internal/hounsfield.h>

#include <fmt/format.h>

#include <algorithm>

namespace lefort::io {

namespace {

/// Air around the head is near -1000 HU in every scan; less of it than this is odd.
constexpr std::int16_t kSurelyAir = -500;

/// The patient is at least this dense, as segmentation has it unless told otherwise.
constexpr double kTissueHu = -300.0;

/// Smaller scans show no head whose tissues could be compared.
constexpr double kMinHead_ml = 500.0;

/// Where the means of air and of what is neither air nor bone lie in scans in HU: air in the airway
/// is blurred, and soft tissue is mixed with fat and the rims of bone.
constexpr double kAirFromHu = -1100.0, kAirToHu = -880.0;
constexpr double kSoftFromHu = -150.0, kSoftToHu = 180.0;

/// Less of an abrupt end than this may be a voxel of noise here and there.
constexpr double kMinCut_mm2 = 100.0;

}  // namespace

std::vector<std::string> hounsfield_warnings(const HounsfieldCount& count,
                                             const image::CtVolume& ct) {
  std::vector<std::string> warnings;
  if (count.beyond_range > 0)
    warnings.push_back(
        fmt::format("{} of {} voxels lay beyond {} to {} HU and were set to the limit",
                    count.beyond_range, ct.values.size(), kLowestHu, kHighestHu));
  if (count.not_a_number > 0)
    warnings.push_back(fmt::format("{} of {} voxels were no numbers and were set to air",
                                   count.not_a_number, ct.values.size()));
  const auto [lowest, highest] = std::minmax_element(ct.values.begin(), ct.values.end());
  if (lowest != ct.values.end() && *lowest > kSurelyAir)
    warnings.push_back(fmt::format(
        "the values reach from {} to {}, expected air near -1000: they may not be in HU", *lowest,
        *highest));
  else if (static_cast<double>(ct.grid.voxel_count()) * ct.grid.spacing_mm.prod() >
           kMinHead_ml * 1e3) {
    if (const auto found = anatomy::find_thresholds(ct);
        found && (found->air_mean_hu < kAirFromHu || found->air_mean_hu > kAirToHu ||
                  found->soft_mean_hu < kSoftFromHu || found->soft_mean_hu > kSoftToHu))
      warnings.push_back(fmt::format(
          "air lies near {:.0f} and soft tissue near {:.0f}, expected about -1000 and 40: the "
          "values are not quite HU, so segment with thresholds from the histogram",
          found->air_mean_hu, found->soft_mean_hu));
  }
  if (const image::Padding padding = image::find_padding(ct, kTissueHu);
      padding.cut_mm2 > kMinCut_mm2)
    warnings.push_back(fmt::format(
        "the field of view is surrounded by {} HU and cuts tissue off over {:.2g} cm2, where its "
        "edge is taken for skin",
        padding.hu, padding.cut_mm2 * 1e-2));
  return warnings;
}

}  // namespace lefort::io
