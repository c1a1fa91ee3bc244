#include <lefort/io/internal/tar_reader.h>

#include <fmt/format.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>

namespace lefort::io {
namespace {

constexpr std::size_t kBlock = 512;
constexpr std::size_t kTarChunk = 1 << 20;

using TarBlock = std::array<char, kBlock>;

/// Parses octal digits padded with spaces and NULs; nothing for other text, including the base-256
/// form of entries over 8 GiB.
std::optional<std::uint64_t> octal(std::string_view text) {
  std::uint64_t value = 0;
  bool ended = false;
  for (const char c : text) {
    if (c == ' ' || c == '\0') {
      ended = ended || value > 0;
      continue;
    }
    if (ended || c < '0' || c > '7') return std::nullopt;
    value = value * 8 + static_cast<std::uint64_t>(c - '0');
  }
  return value;
}

/// Header of an archive member.
struct Entry {
  std::string name;  ///< Without folders.
  std::uint64_t size;
  bool regular;
};

/// Parses a header block; nothing if its checksum is wrong.
std::optional<Entry> parse_header(const TarBlock& block) {
  const std::string_view text(block.data(), block.size());
  std::uint64_t sum = 0;
  for (std::size_t at = 0; at < kBlock; ++at)  // The checksum field counts as spaces.
    sum += at >= 148 && at < 156 ? 32U : static_cast<unsigned char>(block[at]);
  if (octal(text.substr(148, 8)) != sum) return std::nullopt;
  const auto size = octal(text.substr(124, 12));
  if (!size) return std::nullopt;
  std::string name(text.substr(0, std::min<std::size_t>(text.find('\0'), 100)));
  name.erase(0, name.rfind('/') + 1);
  const char type = block[156];
  return Entry{std::move(name), *size, type == '0' || type == '\0'};
}

/// The uncompressed bytes of the archive in order.
class Stream {
 public:
  explicit Stream(int archive) : file_(nullptr, gzclose) {
    if (::lseek(archive, 0, SEEK_SET) == 0) file_.reset(gzdopen(::dup(archive), "rb"));
  }

  /// Reads `count` bytes; false if there are fewer.
  bool read(char* target, std::size_t count) {
    unpacked_ += count;
    if (file_ == nullptr || unpacked_ > kMaxUnpacked) return false;
    return gzread(file_.get(), target, static_cast<unsigned>(count)) == static_cast<int>(count);
  }

 private:
  std::unique_ptr<gzFile_s, int (*)(gzFile)> file_;
  std::uint64_t unpacked_ = 0;
};

/// Reads `size` bytes and the padding of their last block; returns them if `keep` is set, otherwise
/// an empty string.
Result<std::string> read_body(Stream& stream, std::uint64_t size, bool keep) {
  std::string body;
  std::string chunk;
  const std::uint64_t padded = (size + kBlock - 1) / kBlock * kBlock;
  for (std::uint64_t done = 0; done < padded;) {
    chunk.resize(static_cast<std::size_t>(std::min<std::uint64_t>(kTarChunk, padded - done)));
    if (!stream.read(chunk.data(), chunk.size()))
      return fail(ErrorCode::kFileCorrupt, "the archive is truncated or damaged");
    // Grows with the bytes that are read, so a wrong size costs no memory.
    if (keep) body += chunk;
    done += chunk.size();
  }
  if (keep) body.resize(static_cast<std::size_t>(size));
  return body;
}

}  // namespace

Result<std::string> read_from_tar(int archive, std::string_view name, std::uint64_t max_bytes) {
  Stream stream(archive);
  for (TarBlock block; stream.read(block.data(), kBlock);) {
    if (std::all_of(block.begin(), block.end(), [](char c) { return c == '\0'; })) break;
    const std::optional<Entry> entry = parse_header(block);
    if (!entry) return fail(ErrorCode::kFileCorrupt, "the file is not a tar archive or is damaged");
    const bool wanted = entry->regular && entry->name == name;
    const std::uint64_t limit = wanted ? max_bytes : kMaxUnpacked;
    if (entry->size > limit)
      return fail(ErrorCode::kFileCorrupt,
                  fmt::format("{} in the archive has {} bytes, expected at most {}",
                              wanted ? name : "an entry", entry->size, limit));
    LEFORT_TRY(std::string body, read_body(stream, entry->size, wanted));
    if (wanted) return body;
  }
  return fail(ErrorCode::kFileCorrupt, fmt::format("the archive has no entry {}", name));
}

}  // namespace lefort::io
