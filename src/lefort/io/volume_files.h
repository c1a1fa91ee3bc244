/// \file
/// Scans and other volumes in the file formats of research: NRRD, NIfTI and MetaImage.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/image/volume.h>
#include <lefort/io/imported_volume.h>

#include <filesystem>

namespace lefort::io {

/// Whether the ending of `file` is one that read_volume() knows.
[[nodiscard]] bool is_volume_file(const std::filesystem::path& file);

/// Reads .nrrd, .nhdr, .nii, .nii.gz, .mha or .mhd as a CT; see import_volume() for what is kept.
///
/// NIfTI files, which are RAS, arrive in L; so do NRRD files in the spaces RAS and LPS. Files that
/// leave open how their voxels lie in the patient or contradict themselves, that are not in mm, and
/// NRRD files in rarer spaces, are refused; so are NIfTI files with voxels that are no finite
/// numbers. The voxels of .nhdr and .mhd must be in one file in the same folder.
[[nodiscard]] Result<ImportedVolume> read_volume(const std::filesystem::path& file,
                                                 Progress& progress = Progress::none());

/// Writes a volume as .nrrd, .nii.gz, .nii or .mha, by the ending of `target`, compressed where the
/// format can; whole or not at all. Equal volumes give equal bytes.
///
/// \returns nothing, or kInvalidArgument (the ending, or a grid that check_grid() refuses) or
///   kFileUnwritable.
[[nodiscard]] Result<void> write_volume(const std::filesystem::path& target,
                                        const image::CtVolume& volume);
[[nodiscard]] Result<void> write_volume(const std::filesystem::path& target,
                                        const image::ScalarVolume& volume);

}  // namespace lefort::io
