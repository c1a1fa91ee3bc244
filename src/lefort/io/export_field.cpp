#include <lefort/io/export_field.h>
#include <lefort/io/internal/field_formats.h>

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <system_error>
#include <utility>

namespace lefort::io {
namespace fs = std::filesystem;

namespace {

/// The volume and its file, which is read back and checked.
constexpr std::uint64_t kCopies = 2;

std::uint64_t machine_bytes() {
  const long pages = ::sysconf(_SC_PHYS_PAGES), page = ::sysconf(_SC_PAGESIZE);
  return std::uint64_t(std::max(pages, 0L)) * std::uint64_t(std::max(page, 0L));
}

/// Checks memory and disk: the size of a dense volume is that of its box.
Result<void> check_room(const fs::path& target, const field::LatticeWindow& window,
                        std::uint64_t max_bytes) {
  const std::uint64_t bytes = std::uint64_t(window.size()) * sizeof(float);
  const auto too_large = [&](ErrorCode code, const char* where, std::uint64_t maximum) {
    return fail(
        code,
        fmt::format("a dense volume of {} x {} x {} samples needs {} bytes, {} has room for {}; "
                    "choose a part with --region or --stride, or write .vdb, which is sparse",
                    window.count[0], window.count[1], window.count[2], bytes, where, maximum));
  };
  if (max_bytes == 0) max_bytes = machine_bytes() / 4 * 3;
  if (bytes > max_bytes / kCopies)
    return too_large(ErrorCode::kOutOfMemory, "memory", max_bytes / kCopies);
  // Its size after compression is not known yet.
  std::error_code error;
  const fs::space_info disk =
      fs::space(target.has_parent_path() ? target.parent_path() : fs::path("."), error);
  if (!error && bytes > disk.available)
    return too_large(ErrorCode::kFileUnwritable, "the disk", disk.available);
  return {};
}

}  // namespace

std::map<std::string, std::string> describe_export(const field::DistanceField& field,
                                                   const field::LatticeWindow& window) {
  const field::FieldFrame& frame = field.frame();
  const bool is_octree = std::holds_alternative<field::Octree>(field.samples());
  return {
      {"lefort_quantity", "signed distance to a surface, negative inside, positive outside"},
      {"lefort_units", "mm"},
      {"lefort_space", "LPS"},
      {"lefort_closed", frame.closed ? "yes" : "no"},
      {"lefort_band_mm", fmt::format("{}", float(frame.band_mm))},
      {"lefort_cell_mm", fmt::format("{}", frame.cell_mm)},
      {"lefort_every", fmt::format("{}", window.every)},
      {"lefort_tolerance_mm", fmt::format("{}", is_octree ? frame.tolerance_mm : 0.0)},
      {"lefort_beyond_band", "lefort_band_mm outside, -lefort_band_mm inside"},
  };
}

float within_band(float sample, float band_mm) {
  const float maximum = std::nextafter(band_mm, 0.0F);
  return std::clamp(sample, -maximum, maximum);
}

Result<FieldExport> export_field(const fs::path& target, const field::DistanceField& field,
                                 const FieldExportOptions& options, Progress& progress) {
  const bool is_vdb = target.extension() == ".vdb";
  if (!is_vdb && target.extension() != ".nrrd")
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("output file {} must end in .vdb or .nrrd", target.string()));
  FieldExport result;
  LEFORT_TRY(result.window, window_of(field.frame(), options.region_B, options.every));
  if (!is_vdb) LEFORT_TRY_VOID(check_room(target, result.window, options.max_bytes));
  progress.begin_stage("export the field");
  LEFORT_TRY(result.count, is_vdb ? write_vdb(target, field, result.window, progress)
                                  : write_nrrd(target, field, result.window, progress));
  return result;
}

}  // namespace lefort::io
