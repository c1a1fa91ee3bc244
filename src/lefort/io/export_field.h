/// \file
/// Distance fields in other formats: OpenVDB level sets and NRRD volumes
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
  int every = 1;                   ///< Every n-th sample along each axis.
  /// Memory limit while a dense volume is written; 0: three quarters of this machine's memory.
  std::uint64_t max_bytes = 0;
};

/// Extent and number of the samples that were written.
struct FieldExport {
  field::LatticeWindow window{};
  field::SampleCount count{};
};

/// Writes the samples of a field atomically, in the format of the ending of `target`:
///
/// .vdb   a sparse OpenVDB level set of floats [mm]: samples in the band are active; beyond the
///        band the value is +-band_mm, negative inside, mostly as tiles. Unknown samples are
///        inactive and have the value +band_mm.
/// .nrrd  all samples of the window as floats, in the space LPS: beyond the band exactly +-band_mm,
///        negative inside, and NaN where unknown. Keys that begin with `lefort_` state this.
///
/// Samples in the band are those of the field, limited to less than band_mm in magnitude, which
/// distinguishes them from samples beyond the band.
///
/// \param target    ends in .vdb or .nrrd.
/// \param field     the field to export.
/// \param options   region, stride and memory limit.
/// \param progress  stage, progress, requests to stop.
/// \returns what was written, or
///   - kInvalidArgument  another ending; no samples in the region with this stride (window_of()); a
///                       level set of fewer than two voxels on each side of the surface, or with
///                       voxels below about 1e-5 mm, the limit of OpenVDB;
///   - kOutOfMemory      a dense volume of more than half of max_bytes (the message states its
///                       size), or a level set that does not fit into memory;
///   - kFileUnwritable   the disk is full, or permission is missing;
///   - kCancelled.
/// \note Equal fields give equal NRRD files; OpenVDB writes a random number into each of its.
[[nodiscard]] Result<FieldExport> export_field(const std::filesystem::path& target,
                                               const field::DistanceField& field,
                                               const FieldExportOptions& options = {},
                                               Progress& progress = Progress::none());

}  // namespace lefort::io
