/// \file
/// The export formats of distance fields; export_field() chooses one.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/field/query/lattice_samples.h>

#include <filesystem>
#include <map>
#include <string>

namespace lefort::io {

/// Returns metadata for programs that read the file, by key.
[[nodiscard]] std::map<std::string, std::string> describe_export(
    const field::DistanceField& field, const field::LatticeWindow& window);

/// Returns the exported value of a known sample: strictly less than band_mm in magnitude, since
/// samples beyond the band are +-band_mm.
[[nodiscard]] float within_band(float sample, float band_mm);

/// As export_field() for OpenVDB. Only this function and bench use OpenVDB.
[[nodiscard]] Result<field::SampleCount> write_vdb(const std::filesystem::path& target,
                                                   const field::DistanceField& field,
                                                   const field::LatticeWindow& window,
                                                   Progress& progress);

/// As export_field() for NRRD. \pre the window fits into memory.
[[nodiscard]] Result<field::SampleCount> write_nrrd(const std::filesystem::path& target,
                                                    const field::DistanceField& field,
                                                    const field::LatticeWindow& window,
                                                    Progress& progress);

}  // namespace lefort::io
