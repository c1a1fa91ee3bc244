/// \file
/// How much memory this process has held at most.
#pragma once

namespace lefort::pipeline {

/// Resident, in MiB, since the process began.
[[nodiscard]] double peak_memory_mb();

}  // namespace lefort::pipeline
