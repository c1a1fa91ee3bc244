#include <lefort/image/resample_slices.h>
#include <lefort/io/dicom.h>
#include <lefort/io/internal/dicom_header.h>
#include <lefort/io/internal/dicom_stack.h>
#include <lefort/io/internal/hounsfield.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace lefort::io {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMaxFiles = 100'000;
constexpr int kMaxFolderDepth = 8;  // Nested folders; DICOM discs have four levels.
/// Max number of files of unknown series, as a fraction of the number of slices.
constexpr double kMaxUnreadable = 0.2;

using Series = std::vector<DicomHeader>;

/// Contents of a folder. Series are sorted by identifier, so that their numbers do not depend on
/// file names.
struct FolderContents {
  std::vector<Series> series;
  std::vector<Error> unreadable;  ///< DICOM files of unknown series.
  std::size_t foreign_files = 0;
};

Result<std::vector<fs::path>> list_files(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> files;
  if (const fs::directory_iterator first(folder, error); error)
    return fail(ErrorCode::kFileNotFound,
                fmt::format("the folder cannot be listed: {}", error.message()));
  constexpr auto kSkip = fs::directory_options::skip_permission_denied;  // For example lost+found.
  for (fs::recursive_directory_iterator entry(folder, kSkip, error), end; !error && entry != end;
       entry.increment(error)) {
    std::error_code ignored;
    if (entry.depth() >= kMaxFolderDepth) entry.disable_recursion_pending();
    if (entry->is_regular_file(ignored)) files.push_back(entry->path());
    if (files.size() > kMaxFiles)
      return fail(ErrorCode::kFileUnsupported,
                  fmt::format("the folder has more than {} files", kMaxFiles));
  }
  if (error)
    return fail(ErrorCode::kFileNotFound,
                fmt::format("the folder cannot be listed: {}", error.message()));
  std::sort(files.begin(), files.end());
  return files;
}

Result<FolderContents> scan_folder(const fs::path& folder, Progress& progress) {
  LEFORT_TRY(const std::vector<fs::path> files, list_files(folder));
  FolderContents contents;
  std::map<std::string, Series> by_uid;
  for (std::size_t n = 0; n < files.size(); ++n) {
    if (progress.stop_requested())
      return fail(ErrorCode::kCancelled, "reading the scan was stopped");
    progress.report(static_cast<double>(n) / static_cast<double>(files.size()));
    auto header = read_dicom_header(files[n], static_cast<Index>(n + 1));
    if (!header)
      contents.unreadable.push_back(std::move(header).error());
    else if (!*header || (*header)->series_uid.empty())  // A DICOMDIR has no series.
      ++contents.foreign_files;
    else
      by_uid[(*header)->series_uid].push_back(**std::move(header));
  }
  for (auto& [uid, series] : by_uid) contents.series.push_back(std::move(series));
  return contents;
}

/// At least two images of a CT.
bool is_ct(const Series& series) {
  return std::count_if(series.begin(), series.end(), [](const DicomHeader& header) {
           return header.modality == "CT" && header.columns > 0 && !header.is_localizer;
         }) >= 2;
}

std::string list_series(const std::vector<Series>& all) {
  std::vector<std::string> lines;
  for (std::size_t n = 0; n < all.size(); ++n) {
    const DicomHeader& first = all[n].front();
    lines.push_back(first.columns > 0
                        ? fmt::format("{} = {}, {} x {}, {} images", n + 1, first.modality,
                                      first.columns, first.rows, all[n].size())
                        : fmt::format("{} = {}, no images", n + 1, first.modality));
  }
  return fmt::format("{}", fmt::join(lines, "; "));
}

Error no_series(const FolderContents& contents) {
  if (!contents.unreadable.empty()) return contents.unreadable[0];
  return {ErrorCode::kFileUnsupported, "the folder has no DICOM files"};
}

/// Returns the index of the requested series, or of the only CT.
Result<std::size_t> choose_series(const FolderContents& contents, int number) {
  const std::vector<Series>& all = contents.series;
  if (all.empty()) return tl::unexpected(no_series(contents));
  if (number != 0) {
    if (number < 0 || number > std::ssize(all))
      return fail(
          ErrorCode::kInvalidArgument,
          fmt::format("there is no series {}, expected one of: {}", number, list_series(all)));
    return static_cast<std::size_t>(number - 1);
  }
  const auto first = std::find_if(all.begin(), all.end(), is_ct);
  if (first == all.end())
    return fail(ErrorCode::kFileUnsupported,
                fmt::format("the folder has no CT series, only: {}", list_series(all)));
  if (std::find_if(std::next(first), all.end(), is_ct) != all.end())
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("the folder has several CT series, choose one by its number: {}",
                            list_series(all)));
  return static_cast<std::size_t>(first - all.begin());
}

/// Makes a stack of the chosen series. A damaged file of the series is an error; a file of unknown
/// series may be the missing slice.
Result<DicomStack> stack_series(Series series, const std::vector<Error>& unreadable) {
  const auto damaged = std::find_if(series.begin(), series.end(), [](const DicomHeader& file) {
    return file.damage.has_value();
  });
  if (damaged != series.end()) return tl::unexpected(*damaged->damage);
  auto stack = stack_dicom_slices(std::move(series));
  if (!stack && !unreadable.empty())
    return fail(stack.error().code,
                fmt::format("{}; the series of {} DICOM files cannot be read, the first is {}",
                            stack.error().message, unreadable.size(), unreadable[0].message));
  return stack;
}

/// Returns warnings about ignored files.
std::vector<std::string> passed_over(const FolderContents& contents, std::size_t chosen) {
  std::vector<std::string> warnings;
  if (contents.foreign_files > 0)
    warnings.push_back(
        fmt::format("{} files are not DICOM images and were ignored", contents.foreign_files));
  if (contents.series.size() > 1)
    warnings.push_back(fmt::format("{} other series were ignored", contents.series.size() - 1));
  std::ptrdiff_t damaged = 0;
  for (std::size_t n = 0; n < contents.series.size(); ++n)
    if (n != chosen)
      damaged += std::count_if(contents.series[n].begin(), contents.series[n].end(),
                               [](const DicomHeader& file) { return file.damage.has_value(); });
  if (damaged > 0) warnings.push_back(fmt::format("{} of their files are damaged", damaged));
  if (!contents.unreadable.empty())
    warnings.push_back(
        fmt::format("{} DICOM files cannot be read and were ignored; if they belong to this "
                    "series, the scan lacks slices at one end; the first is {}",
                    contents.unreadable.size(), contents.unreadable[0].message));
  return warnings;
}

/// Reads the pixels of all slices into one volume, in HU.
Result<image::CtVolume> read_slices(const DicomStack& stack, const std::vector<Rescale>& rescales,
                                    HounsfieldCount& count, Progress& progress) {
  image::CtVolume ct{stack.grid, {}};
  ct.grid.size = {stack.slices.front().columns, stack.slices.front().rows,
                  std::ssize(stack.slices)};
  ct.values.reserve(static_cast<std::size_t>(ct.grid.voxel_count()));
  for (std::size_t k = 0; k < stack.slices.size(); ++k) {
    if (progress.stop_requested())
      return fail(ErrorCode::kCancelled, "reading the scan was stopped");
    LEFORT_TRY(const std::vector<double> stored, read_dicom_pixels(stack.slices[k], progress));
    const auto [slope, intercept] = rescales[k];
    for (const double value : stored)
      ct.values.push_back(hounsfield(slope * value + intercept, count));
    progress.report(static_cast<double>(k + 1) / static_cast<double>(stack.slices.size()));
  }
  if (stack.origins_L.empty()) return ct;
  // Filled with the lowest value of the scan, so that the check for HU values still works.
  const std::int16_t outside = *std::min_element(ct.values.begin(), ct.values.end());
  return image::resample_slices(ct, stack.origins_L, stack.grid, outside);
}

/// Files of unknown series may be slices of the scan. A few may be a damaged scout or report; more
/// may be a part of the head.
Result<void> check_unreadable(const std::vector<Error>& unreadable, std::size_t slices) {
  if (static_cast<double>(unreadable.size()) <= kMaxUnreadable * static_cast<double>(slices))
    return {};
  return fail(ErrorCode::kFileCorrupt,
              fmt::format("{} DICOM files cannot be read in addition to {} slices, expected at "
                          "most a fifth as many: they may be a part of the head; the first is {}",
                          unreadable.size(), slices, unreadable[0].message));
}

/// Describes a series without reading its pixels.
DicomSeriesInfo describe(const Series& series, int number) {
  const DicomHeader& first = series.front();
  DicomSeriesInfo info{.number = number,
                       .modality = first.modality,
                       .images = std::ssize(series),
                       .columns = first.columns,
                       .rows = first.rows,
                       .kernel = first.kernel};
  if (first.pixel_spacing_mm) info.pixel_mm = *first.pixel_spacing_mm;
  if (first.axes_L) {
    Index axis = 0;
    (*first.axes_L)[0].cross((*first.axes_L)[1]).cwiseAbs().maxCoeff(&axis);
    info.orientation = std::array{"sagittal", "coronal", "axial"}[std::size_t(axis)];
  }
  if (!is_ct(series)) {
    info.problem = "not a CT";
    return info;
  }
  const auto stack = stack_series(series, {});
  if (!stack) {
    info.problem = stack.error().message;
    return info;
  }
  info.is_usable = true;
  info.step_mm = stack->grid.spacing_mm.z();
  info.warnings = stack->warnings;
  return info;
}

}  // namespace

Result<std::vector<DicomSeriesInfo>> list_dicom_series(const fs::path& folder, Progress& progress) {
  progress.begin_stage("scan the DICOM files");
  LEFORT_TRY(const FolderContents contents, scan_folder(folder, progress));
  if (contents.series.empty()) return tl::unexpected(no_series(contents));
  std::vector<DicomSeriesInfo> infos;
  for (const Series& series : contents.series)
    infos.push_back(describe(series, static_cast<int>(infos.size()) + 1));
  return infos;
}

Result<ImportedVolume> read_dicom_series(const fs::path& folder, int series, Progress& progress) {
  progress.begin_stage("scan the DICOM files");
  LEFORT_TRY(FolderContents contents, scan_folder(folder, progress));
  LEFORT_TRY(const std::size_t chosen, choose_series(contents, series));
  LEFORT_TRY(const DicomStack stack,
             stack_series(std::move(contents.series[chosen]), contents.unreadable));
  LEFORT_TRY_VOID(check_unreadable(contents.unreadable, stack.slices.size()));

  progress.begin_stage("read the slices");
  ImportedVolume imported;
  imported.source_kind = "DICOM series";
  imported.warnings = stack.warnings;
  imported.stack = stack.report;
  LEFORT_TRY(const std::vector<Rescale> rescales, rescales_of(stack.slices, imported.warnings));
  HounsfieldCount count;
  LEFORT_TRY(imported.ct, read_slices(stack, rescales, count, progress));
  std::ranges::move(passed_over(contents, chosen), std::back_inserter(imported.warnings));
  std::ranges::move(hounsfield_warnings(count, imported.ct), std::back_inserter(imported.warnings));
  return imported;
}

}  // namespace lefort::io
