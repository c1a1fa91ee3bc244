#include <lefort/image/check_grid.h>
#include <lefort/image/flip_axis.h>
#include <lefort/io/internal/hounsfield.h>
#include <lefort/io/internal/plist.h>
#include <lefort/io/internal/run_in_child.h>
#include <lefort/io/internal/tar_reader.h>
#include <lefort/io/internal/volume_header.h>
#include <lefort/io/inv3.h>

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace lefort::io {
namespace fs = std::filesystem;

namespace {

constexpr std::uint64_t kMaxPlist = 1 << 20;
static_assert(std::endian::native == std::endian::little, "matrix.dat is little-endian");

/// Properties of the voxels in main.plist.
struct Project {
  image::Grid grid;  ///< Sizes and spacing only.
  std::string matrix_file;
  bool is_axial;
};

/// Sets position and axes as they are stored: y points to anterior, so the grid is left-handed.
void place_grid(image::Grid& grid) {
  grid.direction(1, 1) = -1.0;
  grid.origin_L.y() = grid.spacing_mm.y() * static_cast<double>(grid.size[1] - 1);
}

template <class T>
std::optional<T> number_at(const FlatPlist& plist, const std::string& place) {
  const auto leaf = plist.find(place);
  if (leaf == plist.end()) return std::nullopt;
  T number{};
  const char* const end = leaf->second.data() + leaf->second.size();
  const auto [rest, error] = std::from_chars(leaf->second.data(), end, number);
  if (error != std::errc() || rest != end) return std::nullopt;
  return number;
}

std::string plist_text(const FlatPlist& plist, const std::string& place) {
  const auto leaf = plist.find(place);
  return leaf == plist.end() ? "" : leaf->second;
}

/// \returns the project, or an error whose message does not contain the file name.
Result<Project> read_project(const std::string& xml) {
  LEFORT_TRY(const FlatPlist plist, read_plist(xml));
  Project project;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    // The shape is in the order z, y, x; the spacing in the order x, y, z.
    const auto size = number_at<Index>(plist, fmt::format("matrix/shape/{}", 2 - axis));
    const auto spacing_mm = number_at<double>(plist, fmt::format("spacing/{}", axis));
    if (!size || !spacing_mm)
      return fail(ErrorCode::kFileCorrupt,
                  "main.plist has no matrix shape and spacing, expected three numbers each");
    project.grid.size[axis] = *size;
    project.grid.spacing_mm[static_cast<Index>(axis)] = *spacing_mm;
  }
  LEFORT_TRY_VOID(image::check_grid(project.grid));
  if (const std::string type = plist_text(plist, "matrix/dtype"); type != "int16" && type != "<i2")
    return fail(ErrorCode::kFileUnsupported, "the voxels of the project do not have type int16");
  if (const std::string modality = plist_text(plist, "modality"); modality == "MRI")
    return fail(ErrorCode::kFileUnsupported, "the project contains an MRI, expected a CT");

  project.matrix_file = plist_text(plist, "matrix/filename");
  const bool plain =
      std::all_of(project.matrix_file.begin(), project.matrix_file.end(), [](char c) {
        return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
               c == '.' || c == '_' || c == '-';
      });
  if (project.matrix_file.empty() || !plain)
    return fail(ErrorCode::kFileCorrupt, "main.plist has no valid file name of the voxels");
  project.is_axial = number_at<int>(plist, "orientation").value_or(1) == 1;
  return project;
}

/// The task of a child: sizes and spacing of the grid, whether the slices are axial, the voxels.
Result<void> inv3_in_child(int input, std::string_view /*request*/, ResultWriter& result) {
  LEFORT_TRY(const std::string xml, read_from_tar(input, "main.plist", kMaxPlist));
  const auto project = read_project(xml);
  if (!project)
    return fail(project.error().code,
                fmt::format("InVesalius project: {}", project.error().message));
  const std::size_t bytes =
      static_cast<std::size_t>(project->grid.voxel_count()) * sizeof(std::int16_t);
  LEFORT_TRY(const std::string matrix, read_from_tar(input, project->matrix_file, bytes));
  if (matrix.size() != bytes)
    return fail(ErrorCode::kFileCorrupt,
                fmt::format("InVesalius project: the voxels have {} bytes, expected {} from the "
                            "shape in main.plist",
                            matrix.size(), bytes));
  for (const Index size : project->grid.size) result.number(std::int64_t{size});
  for (const double spacing_mm : project->grid.spacing_mm) result.number(spacing_mm);
  result.number(std::int32_t{project->is_axial});
  result.bytes(matrix.data(), bytes);
  return {};
}

/// Reads the result of inv3_in_child().
Result<image::CtVolume> take_project(ResultReader& result, bool& is_axial) {
  const auto damaged = [] { return tl::unexpected(damaged_result("the contents of the project")); };
  image::CtVolume ct;
  bool is_complete = true;
  for (Index& size : ct.grid.size) is_complete = is_complete && result.number(size);
  for (double& spacing_mm : ct.grid.spacing_mm)
    is_complete = is_complete && result.number(spacing_mm);
  std::int32_t axial = 0;
  if (!is_complete || !result.number(axial)) return damaged();
  is_axial = axial != 0;
  LEFORT_TRY_VOID(image::check_grid(ct.grid));
  place_grid(ct.grid);
  ct.values.resize(static_cast<std::size_t>(ct.grid.voxel_count()));
  if (!result.bytes(ct.values.data(), ct.values.size() * sizeof(std::int16_t)) || !result.at_end())
    return damaged();
  return ct;
}

}  // namespace

Result<ImportedVolume> read_inv3(const fs::path& file, Progress& progress) {
  progress.begin_stage("read the scan");
  std::error_code error;
  if (!fs::is_regular_file(file, error))
    return fail(ErrorCode::kFileNotFound, "the file does not exist or is not a regular file");
  LEFORT_TRY(const OpenedFile input, open_input(file, "the file"));
  const std::uint64_t unpacked = std::min(input.bytes * kMaxGzipRatio, kMaxUnpacked);
  // The text of an entry doubles its memory when it grows.
  LEFORT_TRY(ReaderValues values,
             run_in_child(input.descriptor,
                          {inv3_in_child,
                           "the contents of the project",
                           {},
                           limits_of(unpacked / kMaxInflatedPerText, 3 * unpacked)},
                          progress));
  bool is_axial = true;
  ImportedVolume imported;
  imported.source_kind = "InVesalius project";
  LEFORT_TRY(imported.ct, take_project(*values, is_axial));
  progress.report(0.8);
  HounsfieldCount count;
  for (std::int16_t& value : imported.ct.values) value = hounsfield(value, count);
  flip_axis(imported.ct, 1);
  imported.warnings = hounsfield_warnings(count, imported.ct);
  if (!is_axial)
    imported.warnings.emplace_back(
        "the project was not made from axial slices: check left and right");
  progress.report(1.0);
  return imported;
}

}  // namespace lefort::io
