/// \file
/// What ITK 5.2 does not tell of volume files, and must be known before their voxels are believed.
///
/// Of a truncated NIfTI file it makes zeros, of a truncated or damaged MetaImage whatever the
/// memory held before. It mirrors the patient of NRRD files in the space LAS, and guesses where
/// NRRD and NIfTI files leave open how the voxels lie in the patient. NIfTI's library prints.
#pragma once

#include <lefort/core/error.h>

#include <cstdint>
#include <filesystem>

namespace lefort::io {

/// Checks header, orientation and length of a .nii or .nii.gz file, before ITK sees it.
///
/// \returns nothing, or kFileCorrupt or kFileUnsupported; the message does not name the file.
[[nodiscard]] Result<void> check_nifti(const std::filesystem::path& file);

/// Checks that the space of a .nrrd or .nhdr file is LPS or RAS.
///
/// \returns nothing, or kFileUnsupported; the message does not name the file.
[[nodiscard]] Result<void> check_nrrd(const std::filesystem::path& file);

/// Checks that a .mha or .mhd file and what it refers to hold `bytes` of voxels, and unpacks them
/// once if they are compressed.
///
/// \returns as check_nifti().
[[nodiscard]] Result<void> check_metaimage(const std::filesystem::path& file, std::uint64_t bytes);

}  // namespace lefort::io
