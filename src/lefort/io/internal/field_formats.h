/// \file
/// One function per format that a distance field is exported to, chosen by export_field().
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/field/query/lattice_samples.h>

#include <filesystem>
#include <map>
#include <string>

namespace lefort::io {

/// What a program that reads the file should know, by key.
[[nodiscard]] std::map<std::string, std::string> describe_export(
    const field::DistanceField& field, const field::LatticeWindow& window);

/// A known sample as it is exported: strictly within the band, as what lies beyond is +-band_mm.
[[nodiscard]] float within_band(float sample, float band_mm);

/// As export_field(), OpenVDB; the only file but bench that knows it.
[[nodiscard]] Result<field::SampleCount> write_vdb(const std::filesystem::path& target,
                                                   const field::DistanceField& field,
                                                   const field::LatticeWindow& window,
                                                   Progress& progress);

/// As export_field(), NRRD. \pre the window fits into memory.
[[nodiscard]] Result<field::SampleCount> write_nrrd(const std::filesystem::path& target,
                                                    const field::DistanceField& field,
                                                    const field::LatticeWindow& window,
                                                    Progress& progress);

}  // namespace lefort::io
