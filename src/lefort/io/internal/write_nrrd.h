/// \file
/// Writes NRRD files (http://teem.sourceforge.net/nrrd/format.html).
#pragma once

#include <lefort/core/error.h>
#include <lefort/io/internal/raw_volume.h>

#include <filesystem>

namespace lefort::io {

/// Writes header and voxels, compressed by gzip. Blocks of voxels are compressed in parallel; the
/// bytes do not depend on the number of threads.
///
/// \param file    to write; not atomically.
/// \param volume  with a valid grid and values of type kUint8, kInt16 or kFloat.
/// \returns nothing, or kFileUnwritable if the disk is full or failing.
/// \throws std::bad_alloc
[[nodiscard]] Result<void> write_nrrd(const std::filesystem::path& file,
                                      const RawVolumeView& volume);

}  // namespace lefort::io
