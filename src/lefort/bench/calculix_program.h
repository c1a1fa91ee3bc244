/// \file
/// Input, run and output of CalculiX's `ccx`, for all comparisons with it.
#pragma once

#include <lefort/bench/run_process.h>
#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/mesh/volume_mesh.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace lefort::bench {

/// Numbers of nodes or elements from 1, for the data lines of a set.
[[nodiscard]] std::string calculix_list(const std::vector<std::int32_t>& numbers);

/// `*NODE` with the node set ALL and `*ELEMENT` with the element set BLOCK.
/// \param mesh  one block of tet10 (C3D10) or hex8 (C3D8); the order of their nodes is VTK's.
[[nodiscard]] std::string calculix_mesh(const mesh::VolumeMesh& mesh);

/// \param residual  tolerance of the residual force and of the correction, each relative to its
///   mean, without exceptions.
/// \returns `*CONTROLS` of a step.
[[nodiscard]] std::string calculix_tolerance(double residual);

/// Runs ccx on `folder`/`name`.inp, in the folder, because it writes files where it starts. Its
/// output is saved as `name`.log.
///
/// \returns the run; kInvalidArgument if ccx is not installed, kNotConverged if it fails, for any
///   reason; kFileUnwritable; kCancelled.
[[nodiscard]] Result<ProcessRun> run_ccx(const std::filesystem::path& folder,
                                         const std::string& name, int threads, Progress& progress);

/// \returns the number after the last `label` in an output of ccx; or kFileCorrupt.
[[nodiscard]] Result<double> last_number(std::string_view text, std::string_view label);

/// How often the label occurs.
[[nodiscard]] int count_of(std::string_view text, std::string_view label);

}  // namespace lefort::bench
