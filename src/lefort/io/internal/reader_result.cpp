#include <lefort/io/internal/reader_result.h>

#include <unistd.h>

#include <cerrno>

namespace lefort::io {

namespace {
constexpr std::size_t kBuffer = 1 << 16;
}

void ResultWriter::bytes(const void* data, std::size_t count) {
  const char* const first = static_cast<const char*>(data);
  if (buffer_.size() + count > kBuffer) {
    write(buffer_.data(), buffer_.size());
    buffer_.clear();
  }
  if (count > kBuffer)
    write(first, count);
  else
    buffer_.insert(buffer_.end(), first, first + count);
}

bool ResultWriter::flush() {
  write(buffer_.data(), buffer_.size());
  buffer_.clear();
  return is_good_;
}

void ResultWriter::write(const char* data, std::size_t count) {
  while (is_good_ && count > 0) {
    const ssize_t written = ::pwrite(file_, data, count, static_cast<off_t>(at_));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) {
      is_good_ = false;
      return;
    }
    data += written;
    count -= static_cast<std::size_t>(written);
    at_ += static_cast<std::uint64_t>(written);
  }
}

bool ResultReader::bytes(void* target, std::size_t count) {
  if (count > rest_.size()) return false;
  if (count > 0) std::memcpy(target, rest_.data(), count);
  rest_ = rest_.subspan(count);
  return true;
}

bool ResultReader::count(std::size_t& items, std::size_t bytes_each) {
  std::uint64_t found = 0;
  if (rest_.size() < sizeof(found)) return false;
  std::memcpy(&found, rest_.data(), sizeof(found));
  if (found > (rest_.size() - sizeof(found)) / bytes_each) return false;
  rest_ = rest_.subspan(sizeof(found));
  items = static_cast<std::size_t>(found);
  return true;
}

bool ResultReader::text(std::string& text) {
  std::size_t length = 0;
  if (!count(length, 1)) return false;
  text.resize(length);
  return bytes(text.data(), length);
}

}  // namespace lefort::io
