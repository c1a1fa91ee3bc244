/// \file
/// Reading of an untrusted file in a child process without rights.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/io/internal/fork_server.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

namespace lefort::io {

/// An open input.
struct OpenedFile {
  Descriptor descriptor;
  std::uint64_t bytes = 0;  ///< Its size; 0 if it is not a regular file.
};

/// Opens a file for a child. Opening a pipe without a writer does not block; reading it does.
///
/// \returns the file, or kFileNotFound with `name_in_messages` in the message.
[[nodiscard]] Result<OpenedFile> open_input(const std::filesystem::path& file,
                                            const std::string& name_in_messages);

/// Opens a regular file of at most `max_bytes`; errors as those of read_text().
[[nodiscard]] Result<OpenedFile> open_input(const std::filesystem::path& file,
                                            std::uint64_t max_bytes);

/// What a child reads.
struct ReaderJob {
  ReaderTask task;
  std::string subject;  ///< In messages, plural: "the voxels".
  std::string request{};
  ReaderLimits limits{};
};

/// The values that a task has written. They are sealed: nothing can change them any more.
class ReaderValues {
 public:
  ReaderValues(std::shared_ptr<const void> mapping, std::span<const std::byte> values)
      : mapping_(std::move(mapping)), reader_(values) {}
  [[nodiscard]] ResultReader& operator*() { return reader_; }
  [[nodiscard]] ResultReader* operator->() { return &reader_; }

 private:
  std::shared_ptr<const void> mapping_;
  ResultReader reader_;
};

/// Returns limits of reading a file: 60 s and 1 s per MB of text, a twentieth of the speed of the
/// slowest format; 1 GiB and `memory_bytes`.
///
/// \param text_bytes    of the file; of inflated bytes, a sixteenth.
/// \param memory_bytes  the most that a valid file needs.
[[nodiscard]] ReaderLimits limits_of(std::uint64_t text_bytes, std::uint64_t memory_bytes);

/// Executes a task in a child process with enter_sandbox() and no other open file.
///
/// \param input     of the task.
/// \param job       what to read, and limits, beyond which the child is killed.
/// \param progress  requests to stop, which kill the child.
/// \returns the values, which the caller must check as those of a file; the error of the task;
///   kFileCorrupt if the child crashed, did a forbidden system call or exceeded a limit;
///   kOutOfMemory if the system starts no child; or kCancelled.
[[nodiscard]] Result<ReaderValues> run_in_child(const Descriptor& input, const ReaderJob& job,
                                                Progress& progress);

/// Returns the error for values that a child should not have written.
[[nodiscard]] Error damaged_result(const std::string& subject);

/// In a child: reads the rest of a file. \returns the bytes, or kFileCorrupt.
[[nodiscard]] Result<std::string> read_all(int input, const std::string& subject);

}  // namespace lefort::io
