/// \file
/// Peak memory of this process.
#pragma once

namespace lefort::pipeline {

/// Largest resident memory since the process started, in MiB.
[[nodiscard]] double peak_memory_mb();

}  // namespace lefort::pipeline
