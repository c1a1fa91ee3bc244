/// \file
/// How much memory this process has held at most.
#pragma once

namespace lefort::app {

/// Resident, in MiB, since the process began.
[[nodiscard]] double peak_memory_mb();

}  // namespace lefort::app
