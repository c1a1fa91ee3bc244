/// \file
/// Distance fields in the formats of others: OpenVDB level sets and NRRD volumes
/// (docs/reference/field-format.md, "In other formats").
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/field/query/lattice_samples.h>

#include <cstdint>
#include <filesystem>
#include <optional>

namespace lefort::io {

struct FieldExportOptions {
  std::optional<Box3> region_B{};  ///< Samples in this box only [mm].
  int every = 1;                   ///< Each n-th sample along each axis.
  /// What a dense volume may take while it is written; 0: three quarters of this machine's memory.
  std::uint64_t max_bytes = 0;
};

/// What was written.
struct FieldExport {
  field::LatticeWindow window{};
  field::SampleCount count{};
};

/// Writes the samples of a field, whole or not at all, by the ending of `target`:
///
/// .vdb   a sparse OpenVDB grid of floats, a level set: samples in the band are active, and beyond
///        it +-band_mm, negative inside, mostly as tiles. Unknown samples are inactive, +band_mm.
/// .nrrd  all samples of the window as floats, in the space LPS: beyond the band exactly +-band_mm,
///        negative inside, and NaN where unknown. Keys beginning with `lefort_` say so.
///
/// Samples in the band are as the field keeps them, but strictly less than band_mm in size, so that
/// they can be told from those beyond it.
///
/// \returns what was written, or
///   - kInvalidArgument  another ending; `every` or the region hold no samples (window_of()); a
///                       level set of fewer than two voxels on each side of the surface;
///   - kOutOfMemory      a dense volume of more than max_bytes; the message says how many;
///   - kFileUnwritable   no room on the disk, or no permission;
///   - kCancelled.
/// \note Equal fields give equal NRRD files; OpenVDB writes a random number into each of its.
[[nodiscard]] Result<FieldExport> export_field(const std::filesystem::path& target,
                                               const field::DistanceField& field,
                                               const FieldExportOptions& options = {},
                                               Progress& progress = Progress::none());

}  // namespace lefort::io
