/// \file
/// A CT from an InVesalius project.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/io/imported_volume.h>

#include <filesystem>

namespace lefort::io {

/// Reads the scan of an `.inv3` file: a gzipped tar with `main.plist` (shape, type, spacing) and
/// the voxels, usually `matrix.dat`.
///
/// InVesalius stores rows from posterior to anterior. They are reversed, so that the result is in
/// frame L: x to the patient's left, y to posterior, z to superior. The project does not contain
/// the position of the patient in the scanner: the origin of L is the first voxel of the result.
///
/// \param file      the project.
/// \param progress  stage, requests to stop.
/// \returns as import_volume().
[[nodiscard]] Result<ImportedVolume> read_inv3(const std::filesystem::path& file,
                                               Progress& progress = Progress::none());

}  // namespace lefort::io
