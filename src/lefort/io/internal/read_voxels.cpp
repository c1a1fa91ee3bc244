#include <lefort/image/check_grid.h>
#include <lefort/io/internal/header_lines.h>
#include <lefort/io/internal/run_in_child.h>
#include <lefort/io/internal/volume_header.h>

#include <fmt/format.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace lefort::io {
namespace {

constexpr std::size_t kVoxelChunk = 1 << 20;
/// The longest number of a text has 24 characters; the rest is white space.
constexpr std::uint64_t kMaxTextPerValue = 64;

Error damaged_voxels() { return {ErrorCode::kFileCorrupt, "the voxels are truncated or damaged"}; }

Error stopped() { return {ErrorCode::kCancelled, "reading the voxels was stopped"}; }

/// The stored bytes in order.
class StoredBytes {
 public:
  StoredBytes(int file, std::uint64_t begin, std::uint64_t count)
      : file_(file), at_(begin), left_(count) {}
  /// Reads `target.size()` bytes; false if there are fewer.
  bool read(std::span<std::byte> target) {
    while (!target.empty()) {
      const std::size_t got = some(target.data(), target.size());
      if (got == 0) return false;
      target = target.subspan(got);
    }
    return true;
  }
  /// Returns the next bytes, at most one megabyte; nothing at the end.
  std::span<char> next() {
    chunk_.resize(kVoxelChunk);
    return std::span(chunk_).first(some(chunk_.data(), chunk_.size()));
  }
  [[nodiscard]] std::uint64_t left() const { return left_; }

 private:
  std::size_t some(void* target, std::size_t wanted) {
    wanted = static_cast<std::size_t>(std::min<std::uint64_t>(left_, wanted));
    const ssize_t got = ::pread(file_, target, wanted, static_cast<off_t>(at_));
    const auto count = static_cast<std::size_t>(std::max<ssize_t>(got, 0));
    at_ += count;
    left_ -= count;
    return count;
  }

  int file_;
  std::uint64_t at_, left_;
  std::vector<char> chunk_;
};

Result<void> copy_voxels(StoredBytes& stored, std::span<std::byte> target, Progress& progress) {
  for (std::size_t at = 0; at < target.size(); at += kVoxelChunk) {
    if (progress.stop_requested()) return tl::unexpected(stopped());
    if (!stored.read(target.subspan(at, std::min(kVoxelChunk, target.size() - at))))
      return fail(ErrorCode::kFileCorrupt, "the voxels cannot be read to their end");
  }
  return {};
}

/// What a child decompresses.
struct DeflatedVoxels {
  std::uint64_t begin = 0, stored = 0;  ///< First byte and number of compressed bytes.
  std::uint64_t bytes = 0;              ///< Of the voxels.
  std::uint64_t is_exact = 0;           ///< There is one stream, and no byte after it.
};

/// Decompresses a zlib stream or the members of a gzip file, which must have exactly the voxels,
/// with valid checksums.
Result<void> inflate_voxels(StoredBytes& stored, const DeflatedVoxels& expected,
                            ResultWriter& result) {
  z_stream zip{};
  if (inflateInit2(&zip, 15 + 32) != Z_OK) return tl::unexpected(damaged_voxels());  // Either kind.
  const std::unique_ptr<z_stream, int (*)(z_stream*)> cleanup(&zip, inflateEnd);
  std::vector<Bytef> unpacked(kVoxelChunk);
  std::uint64_t left = expected.bytes;
  const auto refill = [&] {
    if (zip.avail_in > 0) return true;
    const std::span<char> packed = stored.next();
    zip.next_in = reinterpret_cast<Bytef*>(packed.data());
    zip.avail_in = static_cast<uInt>(packed.size());
    return !packed.empty();
  };
  while (true) {
    if (!refill()) return tl::unexpected(damaged_voxels());
    // At the end there is room for one byte, which must not be written.
    const auto room = static_cast<uInt>(std::clamp<std::uint64_t>(left, 1, unpacked.size()));
    zip.next_out = unpacked.data();
    zip.avail_out = room;
    const int state = inflate(&zip, Z_NO_FLUSH);
    const uInt written = room - zip.avail_out;
    if ((state != Z_OK && state != Z_STREAM_END) || written > left)
      return tl::unexpected(damaged_voxels());
    result.bytes(unpacked.data(), written);
    left -= written;
    if (state != Z_STREAM_END) continue;
    if (left == 0) break;
    if (expected.is_exact != 0 || !refill() || inflateReset(&zip) != Z_OK)
      return tl::unexpected(damaged_voxels());
  }
  if (expected.is_exact != 0 && (zip.avail_in > 0 || stored.left() > 0))
    return tl::unexpected(damaged_voxels());
  return {};
}

/// The task of a child. \param request  a DeflatedVoxels.
Result<void> inflate_in_child(int input, std::string_view request, ResultWriter& result) {
  DeflatedVoxels expected;
  if (request.size() != sizeof(expected)) return tl::unexpected(damaged_voxels());
  std::memcpy(&expected, request.data(), sizeof(expected));
  StoredBytes stored(input, expected.begin, expected.stored);
  return inflate_voxels(stored, expected, result);
}

Result<void> read_deflated(const OpenedFile& input, const DeflatedVoxels& expected,
                           std::span<std::byte> target, Progress& progress) {
  const std::string request(reinterpret_cast<const char*>(&expected), sizeof(expected));
  LEFORT_TRY(ReaderValues values,
             run_in_child(input.descriptor,
                          {inflate_in_child, "the voxels", request,
                           limits_of(expected.bytes / kMaxInflatedPerText, expected.bytes)},
                          progress));
  if (!values->bytes(target.data(), target.size()) || !values->at_end())
    return tl::unexpected(damaged_voxels());
  return {};
}

/// Parses as many numbers as `target` has values of type T.
template <class T>
bool parse_voxels(std::string_view text, std::span<std::byte> target) {
  for (std::size_t at = 0; at < target.size(); at += sizeof(T)) {
    const auto value = exact_numbers<T>(internal::take_word(text), 1);
    if (!value) return false;
    std::memcpy(target.data() + at, value->data(), sizeof(T));
  }
  return internal::take_word(text).empty();
}

Result<void> parse_text(StoredBytes& stored, ScalarType type, std::span<std::byte> target) {
  std::string text(std::size_t(stored.left()), '\0');
  const bool is_good = stored.read(std::as_writable_bytes(std::span(text))) &&
                       with_type(type, [&]<class T>(T) { return parse_voxels<T>(text, target); });
  if (!is_good)
    return fail(ErrorCode::kFileCorrupt,
                "the voxels are truncated or damaged, expected one number of their type for each");
  return {};
}

/// Whether `stored` bytes can contain the voxels, so that a wrong size in the header costs no time.
bool can_contain(std::uint64_t stored, VoxelEncoding encoding, std::uint64_t bytes,
                 std::uint64_t values) {
  switch (encoding) {
    case VoxelEncoding::kRaw:
      return stored >= bytes;
    case VoxelEncoding::kDeflated:
      return stored >= bytes / kMaxGzipRatio;
    case VoxelEncoding::kText:
      break;
  }
  return stored + 1 >= 2 * values && stored / kMaxTextPerValue <= values;
}

}  // namespace

Result<void> check_either_hand(image::Grid grid) {
  if (grid.direction.determinant() < 0.0) grid.direction.col(2) *= -1.0;
  return check_grid(grid);
}

void reverse_bytes(std::span<std::byte> bytes, std::size_t width) {
  for (std::size_t at = 0; at + width <= bytes.size(); at += width)
    std::reverse(bytes.begin() + std::ptrdiff_t(at), bytes.begin() + std::ptrdiff_t(at + width));
}

Error missing_voxels(std::uint64_t found, std::uint64_t expected) {
  return {ErrorCode::kFileCorrupt,
          fmt::format("there are {} bytes of voxels, expected {}", found, expected)};
}

Result<void> read_voxels(VolumeHeader& header, Progress& progress) {
  RawVolume& volume = header.volume;
  const VoxelStorage& storage = header.storage;
  const auto values = static_cast<std::uint64_t>(volume.value_count());
  const std::size_t width = scalar_bytes(volume.type);
  const std::uint64_t bytes = values * width;
  LEFORT_TRY(const OpenedFile input, open_input(storage.file, "the file of the voxels"));
  const std::uint64_t size = input.bytes;
  std::uint64_t begin = storage.begin;
  if (storage.is_at_end) begin = std::max(begin, size - std::min(size, bytes));
  const std::uint64_t found = size < begin ? 0 : size - begin;
  if (!can_contain(found, storage.encoding, bytes, values))
    return tl::unexpected(storage.encoding == VoxelEncoding::kRaw ? missing_voxels(found, bytes)
                                                                  : damaged_voxels());
  if (storage.bytes && *storage.bytes != found) return tl::unexpected(damaged_voxels());

  // Zeroed, so that no other memory of the process becomes voxels. The system provides zeroed pages
  // on first use, so a wrong size in the header costs no memory.
  volume.bytes.reset(static_cast<std::byte*>(std::calloc(std::max<std::size_t>(bytes, 1), 1)));
  if (volume.bytes == nullptr)
    return fail(ErrorCode::kFileCorrupt,
                fmt::format("{} bytes of voxels do not fit into memory", bytes));
  const std::span<std::byte> target(volume.bytes.get(), bytes);
  StoredBytes stored(input.descriptor.number(), begin, found);
  if (storage.encoding == VoxelEncoding::kText) return parse_text(stored, volume.type, target);
  if (storage.encoding == VoxelEncoding::kRaw)
    LEFORT_TRY_VOID(copy_voxels(stored, target, progress));
  if (storage.encoding == VoxelEncoding::kDeflated)
    LEFORT_TRY_VOID(
        read_deflated(input, {begin, found, bytes, storage.is_one_stream}, target, progress));
  if (storage.is_big_endian != (std::endian::native == std::endian::big))
    reverse_bytes(target, width);
  return {};
}

}  // namespace lefort::io
