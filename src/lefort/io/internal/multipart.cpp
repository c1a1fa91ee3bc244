#include <lefort/core/check.h>
#include <lefort/io/internal/multipart.h>

#include <algorithm>
#include <cctype>
#include <utility>

namespace lefort::io {

namespace {

/// Longer headers of a part, or longer text before the first part, do not occur in answers of a
/// PACS.
constexpr std::size_t kMaxHeaders = 16'384;

tl::unexpected<Error> not_multipart() {
  return fail(ErrorCode::kFileCorrupt,
              "the server's answer is not a multipart body, expected images in parts");
}

std::string lower(std::string_view text) {
  std::string small(text);
  for (char& c : small) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return small;
}

}  // namespace

std::string multipart_boundary(std::string_view content_type) {
  const std::string small = lower(content_type);
  if (!small.starts_with("multipart/related")) return "";
  bool is_quoted = false;
  for (std::size_t at = 0; at < small.size(); ++at) {
    if (small[at] == '"') is_quoted = !is_quoted;
    if (is_quoted || small[at] != ';') continue;
    const std::size_t name = small.find_first_not_of(" \t", at + 1);
    if (name == std::string::npos || small.compare(name, 9, "boundary=") != 0) continue;
    std::string_view value = content_type.substr(name + 9);
    if (value.starts_with('"')) {
      value.remove_prefix(1);
      const std::size_t end = value.find('"');
      if (end == std::string_view::npos) return "";
      value = value.substr(0, end);
    } else {
      value = value.substr(0, value.find_first_of("; \t"));
    }
    const bool is_printable =
        std::all_of(value.begin(), value.end(), [](char c) { return c >= ' ' && c <= '~'; });
    return value.empty() || value.size() > 70 || !is_printable ? "" : std::string(value);
  }
  return "";
}

MultipartReader::MultipartReader(std::string_view boundary, Sink sink)
    : delimiter_("\r\n--" + std::string(boundary)), sink_(std::move(sink)) {
  LEFORT_CHECK(!boundary.empty());
}

Result<void> MultipartReader::feed(std::string_view bytes) {
  // In pieces, so that `pending_` is small even if many bytes are passed.
  constexpr std::size_t kPiece = std::size_t{1} << 16;
  while (!bytes.empty() && state_ != State::kEpilogue) {
    pending_ += bytes.substr(0, kPiece);
    bytes.remove_prefix(std::min(bytes.size(), kPiece));
    for (bool has_item = true; has_item;) {
      LEFORT_TRY(has_item, step());
    }
  }
  return {};
}

/// Parses one item at the front of `pending_`; false if more bytes are needed.
Result<bool> MultipartReader::step() {
  switch (state_) {
    case State::kPreamble:
    case State::kBody:
      return find_delimiter();
    case State::kDelimiter: {
      // Two hyphens close the body; otherwise blanks and a line break may follow.
      if (pending_.size() < 2) return false;
      if (pending_.starts_with("--")) {
        state_ = State::kEpilogue;
        pending_.clear();
        return false;
      }
      const std::size_t end = pending_.find("\r\n");
      if (end == std::string::npos) {
        if (pending_.size() > kMaxHeaders) return not_multipart();
        return false;
      }
      if (pending_.find_first_not_of(" \t") != end) return not_multipart();
      pending_.erase(0, end);  // The line break remains: there may be no headers.
      LEFORT_TRY_VOID(sink_.begin_part());
      state_ = State::kHeaders;
      return true;
    }
    case State::kHeaders: {
      // An empty line ends the headers; the line break of the boundary is still in `pending_`.
      const std::size_t end = pending_.find("\r\n\r\n");
      if (std::min(end, pending_.size()) > kMaxHeaders) return not_multipart();
      if (end == std::string::npos) return false;
      pending_.erase(0, end + 4);
      state_ = State::kBody;
      return true;
    }
    case State::kEpilogue:
      break;
  }
  pending_.clear();
  return false;
}

Result<bool> MultipartReader::find_delimiter() {
  const bool in_body = state_ == State::kBody;
  const std::size_t found = pending_.find(delimiter_);
  // Bytes that may be the beginning of a delimiter remain.
  const std::size_t sure = found != std::string::npos
                               ? found
                               : pending_.size() - std::min(pending_.size(), delimiter_.size() - 1);
  if (in_body && sure > 0) LEFORT_TRY_VOID(sink_.data(std::string_view(pending_).substr(0, sure)));
  if (!in_body) {
    preamble_ += sure;
    if (preamble_ > kMaxHeaders) return not_multipart();
  }
  pending_.erase(0, sure);
  if (found == std::string::npos) return false;
  pending_.erase(0, delimiter_.size());
  if (in_body) LEFORT_TRY_VOID(sink_.end_part());
  state_ = State::kDelimiter;
  return true;
}

}  // namespace lefort::io
