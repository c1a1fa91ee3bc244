/// \file
/// Scans and other volumes in NRRD, NIfTI and MetaImage files.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/image/volume.h>
#include <lefort/io/imported_volume.h>

#include <filesystem>

namespace lefort::io {

/// Whether read_volume() supports the ending of `file`.
[[nodiscard]] bool is_volume_file(const std::filesystem::path& file);

/// Reads .nrrd, .nhdr, .nii, .nii.gz, .mha or .mhd as a CT, with the conversions of
/// import_volume().
///
/// NIfTI files, which are in RAS, and NRRD files in RAS or LPS are converted to frame L. Files with
/// a missing or inconsistent orientation, files that are not in mm, NRRD files in other spaces, and
/// NIfTI files with voxels that are not finite are rejected. The voxels of .nhdr and .mhd must be
/// in one file in the folder of the header.
///
/// \param file      the volume.
/// \param progress  stage, requests to stop.
/// \returns as import_volume().
[[nodiscard]] Result<ImportedVolume> read_volume(const std::filesystem::path& file,
                                                 Progress& progress = Progress::none());

/// Writes a volume atomically in the format of the ending of `target`, compressed if the format
/// allows it. Equal volumes give equal bytes.
///
/// \param target  ends in .nrrd, .nii.gz, .nii or .mha.
/// \param volume  to write.
/// \returns nothing, kInvalidArgument (the ending, or a grid that check_grid() rejects) or
///   kFileUnwritable.
[[nodiscard]] Result<void> write_volume(const std::filesystem::path& target,
                                        const image::CtVolume& volume);
[[nodiscard]] Result<void> write_volume(const std::filesystem::path& target,
                                        const image::ScalarVolume& volume);

}  // namespace lefort::io
