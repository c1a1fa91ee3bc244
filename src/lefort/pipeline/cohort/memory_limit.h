/// \file
/// The memory of this machine, and the limit of that of this process.
#pragma once

#include <lefort/core/error.h>

namespace lefort::pipeline {

/// Memory of this machine, 1e9 bytes.
[[nodiscard]] double machine_memory_gb();

/// Limits the data of this process (RLIMIT_DATA), after a check that the machine has as much. An
/// allocation beyond the limit then fails; it does not take memory from other processes.
///
/// \param memory_gb  1e9 bytes; > 0.
/// \returns nothing; or kOutOfMemory if the machine has less, or kInvalidArgument if the system
///   rejects the limit.
[[nodiscard]] Result<void> limit_memory(double memory_gb);

}  // namespace lefort::pipeline
