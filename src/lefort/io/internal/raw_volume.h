/// \file
/// Volumes as NRRD, NIfTI and MetaImage files hold them: any scalar type, any number of values per
/// voxel, header fields. The one place that knows ITK's readers and writers.
#pragma once

#include <lefort/core/check.h>
#include <lefort/core/error.h>
#include <lefort/image/volume.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>

namespace lefort::io {

enum class ScalarType {
  kInt8,
  kUint8,
  kInt16,
  kUint16,
  kInt32,
  kUint32,
  kInt64,
  kUint64,
  kFloat,
  kDouble,
};

struct FreeBytes {
  void operator()(std::byte* bytes) const { std::free(bytes); }  // NOLINT: calloc gave them.
};

/// A volume file in memory.
struct RawVolume {
  image::Grid grid;  ///< In L, but perhaps left-handed.
  ScalarType type = ScalarType::kInt16;
  Index components = 1;                           ///< Values per voxel, stored together.
  std::unique_ptr<std::byte[], FreeBytes> bytes;  ///< Values, i fastest after components.
  std::map<std::string, std::string> fields;      ///< Text fields of the header.

  [[nodiscard]] Index value_count() const { return grid.voxel_count() * components; }
};

/// Calls use(std::span<const T>) with the values of `raw` in their own type.
template <class Use>
void with_values(const RawVolume& raw, const Use& use) {
  const auto as = [&]<class T>(const T*) {
    use(std::span<const T>(reinterpret_cast<const T*>(raw.bytes.get()),
                           static_cast<std::size_t>(raw.value_count())));
  };
  switch (raw.type) {
    case ScalarType::kInt8:
      return as(static_cast<const std::int8_t*>(nullptr));
    case ScalarType::kUint8:
      return as(static_cast<const std::uint8_t*>(nullptr));
    case ScalarType::kInt16:
      return as(static_cast<const std::int16_t*>(nullptr));
    case ScalarType::kUint16:
      return as(static_cast<const std::uint16_t*>(nullptr));
    case ScalarType::kInt32:
      return as(static_cast<const std::int32_t*>(nullptr));
    case ScalarType::kUint32:
      return as(static_cast<const std::uint32_t*>(nullptr));
    case ScalarType::kInt64:
      return as(static_cast<const std::int64_t*>(nullptr));
    case ScalarType::kUint64:
      return as(static_cast<const std::uint64_t*>(nullptr));
    case ScalarType::kFloat:
      return as(static_cast<const float*>(nullptr));
    case ScalarType::kDouble:
      return as(static_cast<const double*>(nullptr));
  }
  LEFORT_CHECK(!"a scalar type is missing above");
}

/// A format and the endings it goes by.
enum class VolumeFormat { kNone, kNrrd, kNifti, kMetaImage };

/// By the ending of `file`, in any case.
[[nodiscard]] VolumeFormat volume_format(const std::filesystem::path& file);
[[nodiscard]] const char* name_of(VolumeFormat format);

/// Reads a volume with three dimensions whose place in the patient the file states.
///
/// \returns kFileNotFound, kFileUnsupported or kFileCorrupt; the message does not name the file.
[[nodiscard]] Result<RawVolume> read_raw_volume(const std::filesystem::path& file);

/// What is to be written; `values` is not owned.
struct RawVolumeView {
  const image::Grid& grid;
  ScalarType type;
  const void* values;
  std::map<std::string, std::string> fields;  ///< For NRRD only.
};

/// Writes by the ending of `target`, compressed where the format can, whole or not at all.
[[nodiscard]] Result<void> write_raw_volume(const std::filesystem::path& target,
                                            const RawVolumeView& volume);

}  // namespace lefort::io
