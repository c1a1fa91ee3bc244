/// \file
/// The result of a reader as bytes: a child process writes it, the program checks every size.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace lefort::io {

/// Writes numbers, texts and arrays into a file, in the order in which ResultReader reads them.
class ResultWriter {
 public:
  /// \param file   descriptor; must outlive the object.
  /// \param begin  position of the first byte.
  ResultWriter(int file, std::uint64_t begin) : file_(file), at_(begin) {}

  void bytes(const void* data, std::size_t count);
  template <class T>
  void number(T value) {
    static_assert(std::is_arithmetic_v<T>);
    bytes(&value, sizeof(T));
  }
  void text(std::string_view text) {
    number(std::uint64_t(text.size()));
    bytes(text.data(), text.size());
  }
  template <class T>
  void array(std::span<const T> values) {
    static_assert(std::is_arithmetic_v<T>);
    number(std::uint64_t(values.size()));
    bytes(values.data(), values.size_bytes());
  }

  /// Writes what is still in the buffer; returns whether all bytes were written.
  [[nodiscard]] bool flush();
  [[nodiscard]] std::uint64_t position() const { return at_; }  ///< After flush().

 private:
  void write(const char* data, std::size_t count);

  int file_;
  std::uint64_t at_;
  bool is_good_ = true;
  std::vector<char> buffer_;  ///< Small values; large arrays are written directly.
};

/// Reads what ResultWriter has written. It does not trust the bytes: each function returns false,
/// and changes nothing else, if there are fewer bytes than it needs.
class ResultReader {
 public:
  explicit ResultReader(std::span<const std::byte> bytes) : rest_(bytes) {}

  [[nodiscard]] bool bytes(void* target, std::size_t count);
  template <class T>
  [[nodiscard]] bool number(T& value) {
    static_assert(std::is_arithmetic_v<T> && !std::is_same_v<T, bool>);
    return bytes(&value, sizeof(T));
  }
  /// Reads a number of items that are followed by at least `bytes_each` for each of them.
  [[nodiscard]] bool count(std::size_t& items, std::size_t bytes_each);
  [[nodiscard]] bool text(std::string& text);
  template <class T>
  [[nodiscard]] bool array(std::vector<T>& values) {
    static_assert(std::is_arithmetic_v<T>);
    std::size_t items = 0;
    if (!count(items, sizeof(T))) return false;
    values.resize(items);
    return bytes(values.data(), items * sizeof(T));
  }
  [[nodiscard]] bool at_end() const { return rest_.empty(); }

 private:
  std::span<const std::byte> rest_;
};

}  // namespace lefort::io
