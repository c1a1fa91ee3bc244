/// \file
/// Peak memory of this process.
#pragma once

namespace lefort::pipeline {

/// Largest resident memory since the process started, in MB, 1e6 bytes.
[[nodiscard]] double peak_memory_mb();

}  // namespace lefort::pipeline
