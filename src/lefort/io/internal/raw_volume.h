/// \file
/// NRRD, NIfTI and MetaImage volumes with any scalar type, any number of values per voxel, and
/// header fields. Only writing uses ITK, and no other file uses ITK's writers.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
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
  void operator()(std::byte* bytes) const { std::free(bytes); }  // NOLINT: from calloc.
};

/// A volume file in memory.
struct RawVolume {
  image::Grid grid;  ///< In frame L; may be left-handed.
  ScalarType type = ScalarType::kInt16;
  Index components = 1;                           ///< Values per voxel, contiguous.
  std::unique_ptr<std::byte[], FreeBytes> bytes;  ///< Values; components fastest, then i.
  std::map<std::string, std::string> fields;      ///< Text fields of the header.

  [[nodiscard]] Index value_count() const { return grid.voxel_count() * components; }
};

/// Returns use(T()), T being the C++ type of `type`.
template <class Use>
decltype(auto) with_type(ScalarType type, const Use& use) {
  switch (type) {
    case ScalarType::kInt8:
      return use(std::int8_t{});
    case ScalarType::kUint8:
      return use(std::uint8_t{});
    case ScalarType::kInt16:
      return use(std::int16_t{});
    case ScalarType::kUint16:
      return use(std::uint16_t{});
    case ScalarType::kInt32:
      return use(std::int32_t{});
    case ScalarType::kUint32:
      return use(std::uint32_t{});
    case ScalarType::kInt64:
      return use(std::int64_t{});
    case ScalarType::kUint64:
      return use(std::uint64_t{});
    case ScalarType::kFloat:
      return use(float{});
    case ScalarType::kDouble:
      break;
  }
  return use(double{});
}

/// Bytes of a value.
[[nodiscard]] inline std::size_t scalar_bytes(ScalarType type) {
  return with_type(type, [](auto value) { return sizeof(value); });
}

/// Calls use(std::span<const T>) with the values of `raw`, T being their type.
template <class Use>
void with_values(const RawVolume& raw, const Use& use) {
  with_type(raw.type, [&]<class T>(T) {
    use(std::span<const T>(reinterpret_cast<const T*>(raw.bytes.get()),
                           static_cast<std::size_t>(raw.value_count())));
  });
}

/// File formats of volumes.
enum class VolumeFormat { kNone, kNrrd, kNifti, kMetaImage };

/// Returns the format of the ending of `file`, in upper or lower case.
[[nodiscard]] VolumeFormat volume_format(const std::filesystem::path& file);
[[nodiscard]] const char* name_of(VolumeFormat format);

/// Reads a three-dimensional volume whose file states its position in the patient.
///
/// \param file      with one of the endings of VolumeFormat.
/// \param progress  requests to stop.
/// \returns the volume, kFileNotFound, kFileUnsupported, kFileCorrupt or kCancelled; the message
///   does not contain the file name.
[[nodiscard]] Result<RawVolume> read_raw_volume(const std::filesystem::path& file,
                                                Progress& progress = Progress::none());

/// A volume to write; does not own `values`.
struct RawVolumeView {
  const image::Grid& grid;
  ScalarType type;
  const void* values;
  std::map<std::string, std::string> fields;  ///< Written to NRRD files only.
};

/// Writes atomically in the format of the ending of `target`, compressed if the format allows it.
///
/// \param target  ends in .nrrd, .nii.gz, .nii or .mha.
/// \param volume  with values of type kUint8, kInt16 or kFloat.
/// \returns nothing, kInvalidArgument (ending, grid) or kFileUnwritable.
[[nodiscard]] Result<void> write_raw_volume(const std::filesystem::path& target,
                                            const RawVolumeView& volume);

}  // namespace lefort::io
