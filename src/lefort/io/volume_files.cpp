#include <lefort/core/check.h>
#include <lefort/image/flip_axis.h>
#include <lefort/io/internal/hounsfield.h>
#include <lefort/io/internal/raw_volume.h>
#include <lefort/io/volume_files.h>

#include <fmt/format.h>

namespace lefort::io {

bool is_volume_file(const std::filesystem::path& file) {
  return volume_format(file) != VolumeFormat::kNone;
}

Result<ImportedVolume> read_volume(const std::filesystem::path& file, Progress& progress) {
  progress.begin_stage("read the scan");
  if (progress.stop_requested()) return fail(ErrorCode::kCancelled, "reading the scan was stopped");
  LEFORT_TRY(const RawVolume raw, read_raw_volume(file, progress));
  if (raw.components != 1)
    return fail(ErrorCode::kFileUnsupported,
                fmt::format("the voxels have {} values, expected 1", raw.components));
  progress.report(0.7);
  if (progress.stop_requested()) return fail(ErrorCode::kCancelled, "reading the scan was stopped");

  ImportedVolume imported;
  imported.source_kind = name_of(volume_format(file));
  imported.ct.grid = raw.grid;
  imported.ct.values.reserve(static_cast<std::size_t>(raw.value_count()));
  HounsfieldCount count;
  with_values(raw, [&](const auto values) {
    for (const auto value : values)
      imported.ct.values.push_back(hounsfield(static_cast<double>(value), count));
  });
  if (count.not_a_number == std::ssize(imported.ct.values))
    return fail(ErrorCode::kFileCorrupt, imported.source_kind + " file: no voxel is a number");
  imported.warnings = hounsfield_warnings(count, imported.ct);
  if (imported.ct.grid.direction.determinant() < 0.0) flip_axis(imported.ct, 2);
  progress.report(1.0);
  return imported;
}

Result<void> write_volume(const std::filesystem::path& target, const image::CtVolume& volume) {
  LEFORT_CHECK(std::ssize(volume.values) == volume.grid.voxel_count());
  return write_raw_volume(target, {volume.grid, ScalarType::kInt16, volume.values.data(), {}});
}

Result<void> write_volume(const std::filesystem::path& target, const image::ScalarVolume& volume) {
  LEFORT_CHECK(std::ssize(volume.values) == volume.grid.voxel_count());
  return write_raw_volume(target, {volume.grid, ScalarType::kFloat, volume.values.data(), {}});
}

}  // namespace lefort::io
