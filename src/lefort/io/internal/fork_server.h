/// \file
/// A process that forks a child for each file to read.
///
/// The program itself may have many threads and much memory, both of which a fork would copy:
/// locked mutexes remain locked in the child, and a defect of a reader would have all data of the
/// program at hand. The fork server is forked once, at the start, and has one thread and no open
/// file.
#pragma once

#include <lefort/core/error.h>
#include <lefort/io/internal/descriptor.h>
#include <lefort/io/internal/reader_result.h>
#include <lefort/io/internal/reader_sandbox.h>

#include <cstdint>
#include <string_view>

namespace lefort::io {

/// Reads the file `input` in a child process, with the parameters in `request`. A function, not a
/// closure: its address is the same in the child.
using ReaderTask = Result<void> (*)(int input, std::string_view request, ResultWriter& result);

/// The first bytes of a result file; the values of ResultWriter follow.
struct ResultHeader {
  static constexpr std::uint64_t kComplete = 0x6c65666f72742e31;
  enum State : std::uint32_t { kRead, kError, kNoMemory };
  std::uint64_t magic = 0;  ///< kComplete at the end of a task, otherwise 0.
  State state = kRead;
  std::uint32_t error = 0;   ///< An ErrorCode, if kError; then the values are the message.
  std::uint64_t length = 0;  ///< Bytes of the values.
};

/// A running child.
struct ReaderChild {
  Descriptor process;  ///< Of pidfd_open(): readable when the child has ended.
  Descriptor result;   ///< File in memory, written by the child.
};

/// Starts a child for `task`.
///
/// \param input  descriptor of the file.
/// \returns the child, or kOutOfMemory if the system starts none.
[[nodiscard]] Result<ReaderChild> start_child(ReaderTask task, const Descriptor& input,
                                              std::string_view request, const ReaderLimits& limits);

}  // namespace lefort::io
