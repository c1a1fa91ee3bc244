/// \file
/// Limits of a process that reads an untrusted file.
#pragma once

#include <chrono>
#include <cstddef>

namespace lefort::io {

struct ReaderLimits {
  std::chrono::milliseconds time{30'000};           ///< Wall-clock time and processor time.
  std::size_t memory_bytes = std::size_t{1} << 30;  ///< In addition to that at the start.
};

/// Gives up, for the rest of the life of this process: core files, more than `limits`, files of
/// more than `limits.memory_bytes`, other processors, new privileges, and every system call that a
/// computation on open files does not need. Opening a file fails; other such calls end the process.
///
/// Builds with a sanitizer have no filter of system calls: the sanitizer opens files, starts
/// threads and symbolizers, and maps memory as it needs.
///
/// \returns whether all of it succeeded; otherwise nothing must be read.
[[nodiscard]] bool enter_sandbox(const ReaderLimits& limits);

/// Whether this build has the filter of system calls.
[[nodiscard]] bool filters_system_calls();

}  // namespace lefort::io
