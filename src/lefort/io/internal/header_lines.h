/// \file
/// Lines of the text header of a volume file, and numbers in them.
#pragma once

#include <lefort/core/error.h>
#include <lefort/io/internal/surface_formats.h>

#include <charconv>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace lefort::io {

/// Reads lines that end in "\n" or "\r\n". Every other control character but the tab is rejected: a
/// program that takes such a character for the end of a line would find other fields.
class HeaderLines {
 public:
  /// Limits in bytes; longer headers and lines are rejected. The lines of Slicer's conversion
  /// parameters have 2500 bytes.
  static constexpr std::size_t kMaxHeader = 1 << 20, kMaxLine = 1 << 15;

  /// \param file  a regular file, of which at most kMaxHeader bytes are read.
  /// \returns the lines, or kFileNotFound if the file cannot be read.
  [[nodiscard]] static Result<HeaderLines> open(const std::filesystem::path& file);

  /// \returns the next line without its end, nothing after the last one, or kFileCorrupt.
  [[nodiscard]] Result<std::optional<std::string_view>> next();

  /// Position of the next line in the file, in bytes.
  [[nodiscard]] std::uint64_t position() const { return at_; }
  /// Number of the line that next() returned, from 1.
  [[nodiscard]] int number() const { return number_; }

 private:
  explicit HeaderLines(std::string start) : start_(std::move(start)) {}

  std::string start_;  ///< First bytes of the file.
  std::size_t at_ = 0;
  int number_ = 0;
};

/// Returns `text` in lower case (ASCII).
[[nodiscard]] std::string in_lower_case(std::string_view text);

/// Parses exactly `count` numbers, separated by white space; nothing for any other text.
template <class T>
[[nodiscard]] std::optional<std::vector<T>> exact_numbers(std::string_view text,
                                                          std::size_t count) {
  std::vector<T> numbers;
  for (std::string_view word = internal::take_word(text); !word.empty();
       word = internal::take_word(text)) {
    if (numbers.size() == count) return std::nullopt;
    T number{};
    if constexpr (std::is_floating_point_v<T>) {
      double wide = 0.0;
      if (!internal::parse_number(word, wide)) return std::nullopt;
      number = static_cast<T>(wide);
    } else {
      const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
      if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
    }
    numbers.push_back(number);
  }
  if (numbers.size() != count) return std::nullopt;
  return numbers;
}

}  // namespace lefort::io
