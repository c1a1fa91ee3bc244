/// \file
/// What ITK 5.2 does not tell of volume files, and must be known before their voxels are believed.
///
/// Of a truncated NIfTI file it makes zeros, of a truncated or damaged MetaImage whatever the
/// memory held before. It mirrors the patient of NRRD files in the space LAS, and guesses where
/// files leave open, or contradict themselves about, how the voxels lie in the patient. NaN in
/// NIfTI becomes 0 HU, which is tissue. Headers may name any file of the system as their voxels,
/// and reading a pipe waits forever. NIfTI's library prints.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace lefort::io {

/// Checks header, orientation, length and numbers of a .nii or .nii.gz file, before ITK sees it.
///
/// \returns nothing, or kFileCorrupt or kFileUnsupported; the message does not name the file.
[[nodiscard]] Result<void> check_nifti(const std::filesystem::path& file);

/// Checks that a .nrrd or .nhdr file keeps its voxels in itself or in one file beside it, before
/// ITK sees it.
///
/// \returns as check_nifti().
[[nodiscard]] Result<void> check_nrrd_voxel_file(const std::filesystem::path& file);

/// Checks that the space of a .nrrd or .nhdr file is LPS or RAS, in mm, with directions, and that a
/// voxel file of its own can hold `bytes` of voxels.
///
/// \returns as check_nifti().
[[nodiscard]] Result<void> check_nrrd(const std::filesystem::path& file, std::uint64_t bytes);

/// Checks the orientation of a .mha or .mhd file, and that it or the one file beside it that it
/// refers to holds `bytes` of voxels; unpacks them once if they are compressed.
///
/// \param direction  what ITK makes of the header; columns along i, j, k.
/// \returns as check_nifti().
[[nodiscard]] Result<void> check_metaimage(const std::filesystem::path& file, std::uint64_t bytes,
                                           const Mat3& direction);

/// gzip gains at most 1032 : 1, so a file of n bytes cannot hold more than about this many.
inline constexpr std::uint64_t kHighestCompression = 1100;

/// The complaint about too few voxels.
[[nodiscard]] Error cut_off(std::uint64_t found, std::uint64_t wanted);

/// The file called `name` in the folder of `header`. Only a regular file is one: a header that came
/// from elsewhere must not make us read other folders, devices or pipes.
///
/// \returns its path, or kFileUnsupported for what is no plain name, kFileCorrupt for what is no
///   regular file.
[[nodiscard]] Result<std::filesystem::path> sibling_file(const std::filesystem::path& header,
                                                         std::string_view name);

/// `text` without white space at its ends.
[[nodiscard]] std::string_view trimmed(std::string_view text);

}  // namespace lefort::io
