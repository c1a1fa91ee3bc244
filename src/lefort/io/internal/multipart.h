/// \file
/// Incremental parser of multipart/related (RFC 2387).
#pragma once

#include <lefort/core/error.h>

#include <functional>
#include <string>
#include <string_view>

namespace lefort::io {

/// Returns the boundary parameter of a Content-Type; empty if the type is not multipart/related, or
/// the boundary is missing or does not have 1 to 70 printable characters (RFC 2046).
[[nodiscard]] std::string multipart_boundary(std::string_view content_type);

/// Splits a body into its parts. It stores about 80 KiB of the body at most.
class MultipartReader {
 public:
  struct Sink {
    std::function<Result<void>()> begin_part;
    std::function<Result<void>(std::string_view)> data;  ///< A piece of the current part.
    std::function<Result<void>()> end_part;
  };

  /// \pre `boundary` is not empty.
  MultipartReader(std::string_view boundary, Sink sink);

  /// Parses the next bytes, which may end anywhere.
  ///
  /// \param bytes  the next piece of the body.
  /// \returns nothing, kFileCorrupt if this is not a multipart body, or the error of the sink;
  ///   after an error no more bytes may be passed.
  [[nodiscard]] Result<void> feed(std::string_view bytes);

  /// Whether the closing boundary was found. Without it the body is incomplete.
  [[nodiscard]] bool is_complete() const { return state_ == State::kEpilogue; }

 private:
  enum class State { kPreamble, kDelimiter, kHeaders, kBody, kEpilogue };

  [[nodiscard]] Result<bool> step();
  [[nodiscard]] Result<bool> find_delimiter();

  std::string delimiter_;  ///< CR LF, two hyphens and the boundary.
  Sink sink_;
  State state_ = State::kPreamble;
  std::size_t preamble_ = 0;      ///< Number of bytes before the first boundary.
  std::string pending_ = "\r\n";  ///< The first boundary needs no preceding line.
};

}  // namespace lefort::io
