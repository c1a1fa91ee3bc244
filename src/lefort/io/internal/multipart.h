/// \file
/// multipart/related (RFC 2387), taken apart as it arrives.
#pragma once

#include <lefort/core/error.h>

#include <functional>
#include <string>
#include <string_view>

namespace lefort::io {

/// The boundary parameter of a Content-Type; empty if it is no multipart/related or has none that
/// is allowed (1 to 70 characters, RFC 2046).
[[nodiscard]] std::string multipart_boundary(std::string_view content_type);

/// Cuts a body into its parts. Holds little of it at a time: headers, or some 64 KiB.
class MultipartReader {
 public:
  struct Sink {
    std::function<Result<void>()> begin_part;
    std::function<Result<void>(std::string_view)> data;  ///< Some of the current part.
    std::function<Result<void>()> end_part;
  };

  /// \pre `boundary` is not empty.
  MultipartReader(std::string_view boundary, Sink sink);

  /// Takes the next bytes, however they were cut.
  ///
  /// \returns kFileCorrupt if they are no multipart body, or what the sink returned; then no more
  ///   may be fed.
  [[nodiscard]] Result<void> feed(std::string_view bytes);

  /// Whether the closing boundary has come: without it something is missing.
  [[nodiscard]] bool is_complete() const { return state_ == State::kEpilogue; }

 private:
  enum class State { kPreamble, kDelimiter, kHeaders, kBody, kEpilogue };

  [[nodiscard]] Result<bool> step();
  [[nodiscard]] Result<bool> find_delimiter();

  std::string delimiter_;  ///< CR LF, two hyphens and the boundary.
  Sink sink_;
  State state_ = State::kPreamble;
  std::size_t preamble_ = 0;      ///< Bytes before the first boundary.
  std::string pending_ = "\r\n";  ///< As if a line ended before the first boundary.
};

}  // namespace lefort::io
