#include <lefort/image/check_grid.h>
#include <lefort/image/flip_axis.h>
#include <lefort/io/internal/hounsfield.h>
#include <lefort/io/internal/plist.h>
#include <lefort/io/internal/tar_reader.h>
#include <lefort/io/inv3.h>

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstring>
#include <optional>

namespace lefort::io {
namespace fs = std::filesystem;

namespace {

constexpr std::uint64_t kMaxPlist = 1 << 20;
static_assert(std::endian::native == std::endian::little, "matrix.dat is little-endian");

/// Properties of the voxels in main.plist.
struct Project {
  image::Grid grid;  ///< As stored: y points to anterior, so the grid is left-handed.
  std::string matrix_file;
  bool is_axial;
};

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
  project.grid.direction(1, 1) = -1.0;
  project.grid.origin_L.y() =
      project.grid.spacing_mm.y() * static_cast<double>(project.grid.size[1] - 1);
  return project;
}

}  // namespace

Result<ImportedVolume> read_inv3(const fs::path& file, Progress& progress) {
  progress.begin_stage("read the scan");
  LEFORT_TRY(const std::string xml, read_from_tar(file, "main.plist", kMaxPlist, progress));
  const auto project = read_project(xml);
  if (!project)
    return fail(project.error().code,
                fmt::format("InVesalius project: {}", project.error().message));
  progress.report(0.1);

  const auto voxels = static_cast<std::size_t>(project->grid.voxel_count());
  const std::size_t bytes = voxels * sizeof(std::int16_t);
  LEFORT_TRY(const std::string matrix, read_from_tar(file, project->matrix_file, bytes, progress));
  if (matrix.size() != bytes)
    return fail(ErrorCode::kFileCorrupt,
                fmt::format("InVesalius project: the voxels have {} bytes, expected {} from the "
                            "shape in main.plist",
                            matrix.size(), bytes));
  progress.report(0.8);

  ImportedVolume imported;
  imported.source_kind = "InVesalius project";
  imported.ct = {project->grid, std::vector<std::int16_t>(voxels)};
  std::memcpy(imported.ct.values.data(), matrix.data(), bytes);
  HounsfieldCount count;
  for (std::int16_t& value : imported.ct.values) value = hounsfield(value, count);
  flip_axis(imported.ct, 1);
  imported.warnings = hounsfield_warnings(count, imported.ct);
  if (!project->is_axial)
    imported.warnings.emplace_back(
        "the project was not made from axial slices: check left and right");
  progress.report(1.0);
  return imported;
}

}  // namespace lefort::io
