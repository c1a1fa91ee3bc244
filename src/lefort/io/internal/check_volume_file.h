/// \file
/// Checks of volume files that ITK 5.2 does not make.
///
/// ITK reads missing voxels of a truncated NIfTI file as zeros and those of a truncated or damaged
/// MetaImage as uninitialized memory. It mirrors NRRD files in the space LAS, and guesses the
/// orientation of files that do not state it or state it inconsistently. NaN in NIfTI becomes 0 HU,
/// which is tissue. A header may name any file of the system as its voxel file, and reading a pipe
/// never ends. The NIfTI library prints to the terminal.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace lefort::io {

/// Checks header, orientation, length and numbers of a .nii or .nii.gz file before ITK reads it.
///
/// \param file  the NIfTI file.
/// \returns nothing, kFileCorrupt or kFileUnsupported; the message does not contain the file name.
[[nodiscard]] Result<void> check_nifti(const std::filesystem::path& file);

/// Checks that the voxels of a .nrrd or .nhdr file are in the file itself or in one file in the
/// same folder, before ITK reads it.
///
/// \returns as check_nifti().
[[nodiscard]] Result<void> check_nrrd_voxel_file(const std::filesystem::path& file);

/// Checks that the space of a .nrrd or .nhdr file is LPS or RAS, in mm, with directions, and that a
/// separate voxel file can contain `bytes` of voxels.
///
/// \returns as check_nifti().
[[nodiscard]] Result<void> check_nrrd(const std::filesystem::path& file, std::uint64_t bytes);

/// Checks the orientation of a .mha or .mhd file, and that it or its one voxel file contains
/// `bytes` of voxels. Compressed voxels are decompressed once for this.
///
/// \param direction  as ITK read it; columns along i, j, k.
/// \returns as check_nifti().
[[nodiscard]] Result<void> check_metaimage(const std::filesystem::path& file, std::uint64_t bytes,
                                           const Mat3& direction);

/// Upper bound of the compression ratio of gzip, which is at most 1032.
inline constexpr std::uint64_t kMaxGzipRatio = 1100;

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
