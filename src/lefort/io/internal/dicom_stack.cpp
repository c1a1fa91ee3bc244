#include <lefort/core/check.h>
#include <lefort/core/units.h>
#include <lefort/image/check_grid.h>
#include <lefort/image/resample_slices.h>
#include <lefort/io/internal/dicom_stack.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace lefort::io {

namespace {

/// Decimal strings in DICOM have 16 characters; scanners round positions to about 0.01 mm.
constexpr double kAxisTolerance = 1e-3;
constexpr double kSpacingToleranceMm = 1e-3;
constexpr double kPositionToleranceMm = 0.02;
constexpr Index kMaxColumns = 8192;  // Checked before a codec allocates memory.
/// Max deviation of a slice distance from the others, as a fraction of it.
constexpr double kUneven = 0.05;
/// Max deviation of a slice from its position in the even stack, as a fraction of the slice
/// distance.
constexpr double kMaxOffEven = 0.1;
/// Max sideways displacement of a slice, as a fraction of a pixel.
constexpr double kMaxSidewaysPixels = 0.5;
/// Gantries tilt by 30 degrees at most; a larger shear has another cause.
constexpr double kMaxTilt_deg = 45.0;
/// Min number of consecutive equal steps of an intended slice distance.
constexpr std::size_t kMinRun = 3;
/// Wider steps lose too much of the face for interpolation.
constexpr double kMaxSliceStepMm = 5.0;

std::string size_of(const DicomHeader& slice) {
  return fmt::format("{} x {}", slice.columns, slice.rows);
}

/// Checks that the position of this slice is known.
Result<void> check_slice(const DicomHeader& slice) {
  const auto unsupported = [&](std::string_view why) {
    return fail(ErrorCode::kFileUnsupported, fmt::format("DICOM {}: {}", name_of(slice), why));
  };
  if (slice.frames != 1)
    return unsupported(fmt::format("it has {} frames, expected one slice", slice.frames));
  if (slice.samples_per_pixel != 1)
    return unsupported(
        fmt::format("it has {} values per pixel, expected 1", slice.samples_per_pixel));
  if (std::min(slice.columns, slice.rows) < 1 || std::max(slice.columns, slice.rows) > kMaxColumns)
    return unsupported(fmt::format("it has {} pixels, expected at most {} along each side",
                                   size_of(slice), kMaxColumns));
  if (!slice.position_L) return unsupported("the image position is missing");
  if (!slice.axes_L) return unsupported("the image orientation is missing");
  if (!slice.pixel_spacing_mm) return unsupported("the pixel spacing is missing");
  const auto& [row, column] = *slice.axes_L;
  const double error = std::max(
      {std::abs(row.norm() - 1.0), std::abs(column.norm() - 1.0), std::abs(row.dot(column))});
  if (!(error <= kAxisTolerance) || !slice.position_L->allFinite())
    return fail(ErrorCode::kFileCorrupt,
                fmt::format("DICOM {}: the image axes deviate by {:.2g} from orthogonal unit "
                            "vectors, expected at most {}",
                            name_of(slice), error, kAxisTolerance));
  return {};
}

/// Checks that `slice` has the size, orientation and spacing of `first`.
Result<void> check_alike(const DicomHeader& first, const DicomHeader& slice) {
  const auto differs = [&](std::string_view what) {
    return fail(ErrorCode::kFileCorrupt,
                fmt::format("the series mixes slices of different {}: {} and {}", what,
                            name_of(first), name_of(slice)));
  };
  if (slice.columns != first.columns || slice.rows != first.rows)
    return differs(fmt::format("size, {} and {}", size_of(first), size_of(slice)));
  for (std::size_t a = 0; a < 2; ++a) {
    if (!(((*slice.axes_L)[a] - (*first.axes_L)[a]).norm() <= kAxisTolerance))
      return differs("orientation");
    if (!(std::abs((*slice.pixel_spacing_mm)[a] - (*first.pixel_spacing_mm)[a]) <=
          kSpacingToleranceMm))
      return differs("pixel spacing");
  }
  return {};
}

/// Exactly orthogonal axes: row, column orthogonalized against it, and their normal.
Mat3 direction_of(const DicomHeader& slice) {
  Mat3 direction;
  direction.col(0) = (*slice.axes_L)[0].normalized();
  direction.col(2) = direction.col(0).cross((*slice.axes_L)[1]).normalized();
  direction.col(1) = direction.col(2).cross(direction.col(0));
  return direction;
}

/// Removes localizers and copies of one slice, with a warning.
void remove_surplus(std::vector<DicomHeader>& slices, std::vector<std::string>& warnings) {
  if (const auto localizers = std::erase_if(slices, [](const auto& s) { return s.is_localizer; }))
    warnings.push_back(fmt::format("{} localizer images were omitted", localizers));
  std::set<std::string> seen;
  const auto copies = std::erase_if(slices, [&](const DicomHeader& slice) {
    return !slice.instance_uid.empty() && !seen.insert(slice.instance_uid).second;
  });
  if (copies > 0) warnings.push_back(fmt::format("{} copies of slices were omitted", copies));
}

/// Equidistant heights along the normal that fit those of the slices best.
struct EvenHeights {
  double first_mm = 0.0;
  double distance_mm = 0.0;
  [[nodiscard]] double at(std::size_t k) const {
    return first_mm + distance_mm * static_cast<double>(k);
  }
};

/// Least-squares fit; \pre `heights_mm` has at least two entries.
EvenHeights fit_even_heights(const std::vector<double>& heights_mm) {
  const auto count = static_cast<double>(heights_mm.size());
  const double mean_k = 0.5 * (count - 1.0);
  const double from_mm = heights_mm.front();  // Differences preserve the digits of an even stack.
  double mean_mm = 0.0, covariance = 0.0;
  for (std::size_t k = 0; k < heights_mm.size(); ++k) {
    mean_mm += (heights_mm[k] - from_mm) / count;
    covariance += (static_cast<double>(k) - mean_k) * (heights_mm[k] - from_mm);
  }
  const double distance_mm = 12.0 * covariance / (count * (count * count - 1.0));
  return {from_mm + mean_mm - mean_k * distance_mm, distance_mm};
}

std::string between(const std::vector<DicomHeader>& slices, std::size_t step) {
  return fmt::format("{} and {}", name_of(slices[step]), name_of(slices[step + 1]));
}

Result<void> check_distinct(const std::vector<DicomHeader>& slices,
                            const std::vector<double>& steps_mm) {
  for (std::size_t k = 0; k < steps_mm.size(); ++k)
    if (steps_mm[k] < 1e-3)
      return fail(
          ErrorCode::kFileCorrupt,
          fmt::format("two slices of the series have the same position: {}", between(slices, k)));
  return {};
}

/// Whether the stack consists of runs of at least kMinRun equal steps, with several step lengths,
/// and without missing slice numbers: then it was scanned with these steps.
bool has_several_distances(const std::vector<DicomHeader>& slices,
                           const std::vector<double>& steps_mm) {
  std::size_t runs = 0;
  for (std::size_t begin = 0; begin < steps_mm.size(); ++runs) {
    std::size_t end = begin + 1;
    while (end < steps_mm.size() && std::abs(steps_mm[end] - steps_mm[begin]) <=
                                        kUneven * steps_mm[begin] + kPositionToleranceMm)
      ++end;
    if (end - begin < kMinRun) return false;
    begin = end;
  }
  for (std::size_t k = 0; k < steps_mm.size(); ++k)
    if (const auto a = slices[k].slice_number, b = slices[k + 1].slice_number;
        a && b && std::abs(*a - *b) > 1)
      return false;
  return runs > 1;
}

/// Rejects gaps of one or more slices.
Result<void> check_gaps(const std::vector<DicomHeader>& slices, const std::vector<double>& steps_mm,
                        double usual_mm) {
  for (std::size_t k = 0; k < steps_mm.size(); ++k) {
    const double skipped = std::round(steps_mm[k] / usual_mm) - 1.0;
    const bool is_multiple =
        std::abs(steps_mm[k] - (skipped + 1.0) * usual_mm) <= kUneven * usual_mm;
    if (skipped >= 1.0 && is_multiple)
      return fail(ErrorCode::kFileCorrupt,
                  fmt::format("{} slices are missing between {}: the gap is {:.3g} mm, expected "
                              "{:.3g} mm",
                              skipped, between(slices, k), steps_mm[k], usual_mm));
  }
  return {};
}

/// Fits an even stack to slices at `heights_mm`; rejects gaps and uneven stacks. Small deviations
/// of steps can add up, so both steps and positions are checked.
Result<EvenHeights> even_heights(const std::vector<DicomHeader>& slices,
                                 const std::vector<double>& heights_mm,
                                 const std::vector<double>& steps_mm,
                                 std::vector<std::string>& warnings) {
  std::vector<double> sorted_mm = steps_mm;
  std::sort(sorted_mm.begin(), sorted_mm.end());
  const double usual_mm = sorted_mm[sorted_mm.size() / 2];
  LEFORT_TRY_VOID(check_gaps(slices, steps_mm, usual_mm));

  const double off_mm = std::max(usual_mm - sorted_mm.front(), sorted_mm.back() - usual_mm);
  const std::string range = fmt::format("the slice distances are {:.4g} to {:.4g} mm",
                                        sorted_mm.front(), sorted_mm.back());
  if (off_mm > kUneven * usual_mm + kPositionToleranceMm)
    return fail(ErrorCode::kFileCorrupt, range + ", expected one distance");
  const EvenHeights even = fit_even_heights(heights_mm);
  std::size_t worst = 0;
  const auto residual_mm = [&](std::size_t k) { return std::abs(heights_mm[k] - even.at(k)); };
  for (std::size_t k = 1; k < heights_mm.size(); ++k)
    if (residual_mm(k) > residual_mm(worst)) worst = k;
  if (residual_mm(worst) > kMaxOffEven * even.distance_mm)
    return fail(ErrorCode::kFileCorrupt,
                fmt::format("{}, and {} is {:.3g} mm from its position in an even stack, expected "
                            "at most {:.3g} mm",
                            range, name_of(slices[worst]), residual_mm(worst),
                            kMaxOffEven * even.distance_mm));
  if (off_mm > kPositionToleranceMm)
    warnings.push_back(fmt::format("{}; {:.4g} mm is used, which moves slices by at most {:.2g} mm",
                                   range, even.distance_mm, residual_mm(worst)));
  return even;
}

/// Makes a grid with the smallest slice distance of a stack with several.
Result<EvenHeights> resampled_heights(const std::vector<double>& heights_mm,
                                      const std::vector<double>& steps_mm,
                                      std::vector<std::string>& warnings) {
  const auto [minimum, maximum] = std::minmax_element(steps_mm.begin(), steps_mm.end());
  const std::string range =
      fmt::format("the slice distances are {:.4g} to {:.4g} mm", *minimum, *maximum);
  if (*maximum > kMaxSliceStepMm)
    return fail(ErrorCode::kFileUnsupported,
                fmt::format("{}, expected at most {:.3g} mm", range, kMaxSliceStepMm));
  const double length_mm = heights_mm.back() - heights_mm.front();
  const EvenHeights even{heights_mm.front(), length_mm / std::round(length_mm / *minimum)};
  warnings.push_back(
      fmt::format("{}; they are resampled to one distance, {:.4g} mm", range, even.distance_mm));
  return even;
}

/// Determines the shear of the stack by gantry tilt. Other sideways displacements are rejected,
/// since no scanner produces them.
///
/// \returns the shear angle, 0 if it is negligible.
Result<double> find_tilt_deg(const DicomStack& stack, std::vector<std::string>& warnings) {
  const Vec3 normal = stack.grid.direction.col(2);
  const Vec3 first_L = *stack.slices.front().position_L;
  const auto path = [&](std::size_t k) -> Vec3 { return *stack.slices[k].position_L - first_L; };
  const auto sideways_mm = [&](std::size_t k) -> Vec3 {
    return path(k) - path(k).dot(normal) * normal;
  };
  const std::size_t last = stack.slices.size() - 1;
  const Vec3 drift_mm = sideways_mm(last);
  const double height_mm = path(last).dot(normal);
  const double limit_mm = kMaxSidewaysPixels * stack.grid.spacing_mm.head<2>().minCoeff();
  double off_path_mm = 0.0;  // From an evenly sheared stack.
  std::size_t worst = 0;
  for (std::size_t k = 0; k <= last; ++k) {
    const double fraction = path(k).dot(normal) / height_mm;
    off_path_mm = std::max(off_path_mm, (sideways_mm(k) - fraction * drift_mm).norm());
    if (sideways_mm(k).norm() > sideways_mm(worst).norm()) worst = k;
  }
  const double reported_deg = stack.slices.front().gantry_tilt_deg;
  if (drift_mm.norm() > limit_mm && off_path_mm <= limit_mm) {
    const double tilt_deg = degrees_from_radians(std::atan2(drift_mm.norm(), height_mm));
    const std::string sheared =
        fmt::format("the slices are sheared by {:.1f} degrees, as by a tilted gantry", tilt_deg);
    if (tilt_deg > kMaxTilt_deg)
      return fail(ErrorCode::kFileUnsupported,
                  fmt::format("{}, expected at most {:.3g}", sheared, kMaxTilt_deg));
    warnings.push_back(sheared + "; they are resampled to an upright stack");
    return tilt_deg;
  }
  if (sideways_mm(worst).norm() > limit_mm)
    return fail(ErrorCode::kFileCorrupt,
                fmt::format("{} is displaced sideways by {:.3g} mm from the first slice, expected "
                            "at most {:.3g} mm",
                            name_of(stack.slices[worst]), sideways_mm(worst).norm(), limit_mm));
  if (std::abs(reported_deg) > 0.1)
    warnings.push_back(fmt::format(
        "the scanner reports a gantry tilt of {:.1f} degrees, but the slices form an upright stack",
        reported_deg));
  return 0.0;
}

}  // namespace

Result<DicomStack> stack_dicom_slices(std::vector<DicomHeader> slices) {
  DicomStack stack;
  remove_surplus(slices, stack.warnings);
  if (slices.size() < 2)
    return fail(ErrorCode::kFileUnsupported,
                fmt::format("the series has {} slices, expected at least 2", slices.size()));
  for (const DicomHeader& slice : slices) {
    LEFORT_TRY_VOID(check_slice(slice));
    LEFORT_TRY_VOID(check_alike(slices.front(), slice));
  }

  const DicomHeader& first = slices.front();
  image::Grid& grid = stack.grid;
  grid.direction = direction_of(first);
  grid.size = {first.columns, first.rows, std::ssize(slices)};
  grid.spacing_mm = {(*first.pixel_spacing_mm)[0], (*first.pixel_spacing_mm)[1], 1.0};

  const Vec3 normal = grid.direction.col(2);
  const auto height_mm = [&](const DicomHeader& slice) { return slice.position_L->dot(normal); };
  std::sort(slices.begin(), slices.end(), [&](const DicomHeader& a, const DicomHeader& b) {
    return std::pair(height_mm(a), a.file_number) < std::pair(height_mm(b), b.file_number);
  });
  std::vector<double> heights_mm, steps_mm;
  for (const DicomHeader& slice : slices) heights_mm.push_back(height_mm(slice));
  for (std::size_t k = 1; k < slices.size(); ++k)
    steps_mm.push_back(heights_mm[k] - heights_mm[k - 1]);
  LEFORT_TRY_VOID(check_distinct(slices, steps_mm));
  const bool is_uneven = has_several_distances(slices, steps_mm);
  LEFORT_TRY(const EvenHeights even,
             is_uneven ? resampled_heights(heights_mm, steps_mm, stack.warnings)
                       : even_heights(slices, heights_mm, steps_mm, stack.warnings));
  grid.spacing_mm.z() = even.distance_mm;
  grid.origin_L = *slices.front().position_L + (even.first_mm - heights_mm.front()) * normal;
  stack.slices = std::move(slices);
  LEFORT_TRY_VOID(image::check_grid(grid));
  LEFORT_TRY(const double tilt_deg, find_tilt_deg(stack, stack.warnings));
  const auto [minimum, maximum] = std::minmax_element(steps_mm.begin(), steps_mm.end());
  stack.report = {.slices = std::ssize(stack.slices),
                  .min_step_mm = *minimum,
                  .max_step_mm = *maximum,
                  .tilt_deg = tilt_deg,
                  .resampled = is_uneven || tilt_deg > 0.0};
  if (!stack.report.resampled) return stack;

  for (std::size_t k = 0; k < stack.slices.size(); ++k) {
    // Nearly even heights are made even, since interpolation between neighbors would blur them.
    const double up_mm = is_uneven ? 0.0 : even.at(k) - heights_mm[k];
    stack.origins_L.push_back(*stack.slices[k].position_L + up_mm * normal);
  }
  const auto count =
      1 + static_cast<Index>(std::lround((is_uneven ? heights_mm.back() - heights_mm.front()
                                                    : even.distance_mm * double(grid.size[2] - 1)) /
                                         even.distance_mm));
  grid = image::regular_grid(grid, stack.origins_L, even.first_mm, even.distance_mm, count);
  LEFORT_TRY_VOID(image::check_grid(grid));
  return stack;
}

Result<std::vector<Rescale>> rescales_of(const std::vector<DicomHeader>& slices,
                                         std::vector<std::string>& warnings) {
  const auto all_or_none = [&](auto tag, std::string_view name,
                               std::string_view otherwise) -> Result<void> {
    const auto count = std::count_if(slices.begin(), slices.end(),
                                     [&](const auto& slice) { return (slice.*tag).has_value(); });
    if (count == 0)
      warnings.push_back(fmt::format("the files have no rescale {}, {} was used", name, otherwise));
    if (count == 0 || count == std::ssize(slices)) return {};
    return fail(ErrorCode::kFileCorrupt,
                fmt::format("{} of {} slices have a rescale {}, expected all or none", count,
                            slices.size(), name));
  };
  LEFORT_TRY_VOID(all_or_none(&DicomHeader::rescale_intercept, "intercept", "0"));
  LEFORT_TRY_VOID(all_or_none(&DicomHeader::rescale_slope, "slope", "1"));
  std::vector<Rescale> rescales;
  for (const DicomHeader& slice : slices) {
    const Rescale rescale{slice.rescale_slope.value_or(1.0), slice.rescale_intercept.value_or(0.0)};
    if (!std::isfinite(rescale.slope) || rescale.slope == 0.0 || !std::isfinite(rescale.intercept))
      return fail(ErrorCode::kFileCorrupt,
                  fmt::format("DICOM {}: the values are rescaled by {} and {}, expected a "
                              "slope other than 0 and an intercept",
                              name_of(slice), rescale.slope, rescale.intercept));
    rescales.push_back(rescale);
  }
  return rescales;
}

}  // namespace lefort::io
