/// \file
/// Readers of NRRD, MetaImage and NIfTI files: a header, and the voxels that it describes.
///
/// They use no library of these formats. MetaIO and NrrdIO (in ITK 5.2) write outside their buffers
/// for some headers, parse some headers differently from a check made before, return missing voxels
/// as zeros or uninitialized memory, mirror some files, and share state between threads.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/io/internal/raw_volume.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>

namespace lefort::io {

enum class VoxelEncoding {
  kRaw,
  kDeflated,  ///< One zlib or gzip stream; gzip may have several members.
  kText,      ///< Numbers, separated by white space.
};

/// Where the voxels are stored, and how.
struct VoxelStorage {
  std::filesystem::path file;          ///< The file of the header, or a regular file in its folder.
  std::uint64_t begin = 0;             ///< First byte in that file.
  std::optional<std::uint64_t> bytes;  ///< Required number of stored bytes to the end of the file.
  VoxelEncoding encoding = VoxelEncoding::kRaw;
  bool is_one_stream = false;  ///< Deflated voxels are one stream without bytes after it.
  bool is_at_end = false;      ///< Raw voxels are the last bytes of the file, not before `begin`.
  bool is_big_endian = false;  ///< Of raw and deflated voxels.
};

/// A header; `volume` has no voxels yet.
struct VolumeHeader {
  RawVolume volume;
  VoxelStorage storage;
};

/// Reads the header of a .nrrd or .nhdr file. Unknown and repeated fields are rejected, as are
/// spaces other than LPS and RAS in mm.
///
/// \returns the header with its key/value pairs as fields, kFileNotFound, kFileCorrupt or
///   kFileUnsupported; the message contains nothing from the file but numbers.
[[nodiscard]] Result<VolumeHeader> read_nrrd_header(const std::filesystem::path& file);

/// Reads the header of a .mha or .mhd file. Lines without a separator and repeated fields are
/// rejected; fields that do not concern the voxels are ignored.
///
/// \returns as read_nrrd_header(), without fields.
[[nodiscard]] Result<VolumeHeader> read_metaimage_header(const std::filesystem::path& file);

/// Reads the voxels into `header.volume`, in the byte order of this machine.
///
/// \pre the grid and the number of components are valid.
/// \returns kFileCorrupt (missing, damaged or too many voxels) or kCancelled.
[[nodiscard]] Result<void> read_voxels(VolumeHeader& header, Progress& progress);

/// Reads a NIfTI-1 file, plain or compressed by gzip. Its scale is applied.
///
/// \returns as read_nrrd_header(), or kCancelled. Numbers that are not finite are rejected.
[[nodiscard]] Result<RawVolume> read_nifti(const std::filesystem::path& file, Progress& progress);

/// Upper bound of the compression ratio of gzip; the largest possible one is 1032.
inline constexpr std::uint64_t kMaxGzipRatio = 1100;
/// Inflated bytes in the time of a byte of text (limits_of()): 320 and 20 MB/s.
inline constexpr std::uint64_t kMaxInflatedPerText = 16;

/// check_grid() that also allows left-handed grids.
[[nodiscard]] Result<void> check_either_hand(image::Grid grid);

/// Reverses the bytes of every value.
void reverse_bytes(std::span<std::byte> bytes, std::size_t width);

/// As read_nifti(), in this process, for a child. \param input  descriptor of a regular file.
[[nodiscard]] Result<RawVolume> decode_nifti(int input);

/// Returns the error for missing voxels.
[[nodiscard]] Error missing_voxels(std::uint64_t found, std::uint64_t expected);

/// Returns the path of the file `name` in the folder of `header`. It must be a regular file: a
/// header from an untrusted source must not cause reading of other folders, devices or pipes.
///
/// \returns the path, kFileUnsupported if `name` is not a plain file name, or kFileCorrupt if it is
///   not a regular file.
[[nodiscard]] Result<std::filesystem::path> sibling_file(const std::filesystem::path& header,
                                                         std::string_view name);

/// Returns `text` without white space at its ends.
[[nodiscard]] std::string_view trimmed(std::string_view text);

}  // namespace lefort::io
