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
/// InVesalius stores rows from posterior to anterior; they are reversed, so that the result is L:
/// x to the patient's left, y to posterior, z to superior. The project does not say where in the
/// scanner the patient lay: the origin of L is the first voxel of the result.
[[nodiscard]] Result<ImportedVolume> read_inv3(const std::filesystem::path& file,
                                               Progress& progress = Progress::none());

}  // namespace lefort::io
