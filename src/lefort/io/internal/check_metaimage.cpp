#include <lefort/io/internal/check_volume_file.h>

#include <zlib.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <initializer_list>
#include <map>
#include <memory>
#include <optional>
#include <vector>

namespace lefort::io {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMetaImageChunk = 1 << 20;
constexpr int kMaxMetaImageLines = 10'000;

Error unsupported(const char* why) { return {ErrorCode::kFileUnsupported, why}; }

/// Text fields of a header; voxels in the same file start at `end`.
struct MetaImageHeader {
  std::map<std::string, std::string> fields;
  std::uint64_t end = 0;

  [[nodiscard]] std::string field(const char* name) const {
    const auto found = fields.find(name);
    return found == fields.end() ? std::string() : found->second;
  }
  /// MetaIO reads the first letter only.
  [[nodiscard]] bool is_true(const char* name) const {
    const std::string text = field(name);
    return text.starts_with('T') || text.starts_with('t') || text.starts_with('1');
  }
  [[nodiscard]] bool has_one_of(std::initializer_list<const char*> names) const {
    return std::any_of(names.begin(), names.end(),
                       [&](const char* name) { return fields.contains(name); });
  }
};

MetaImageHeader read_header(std::ifstream& stream) {
  MetaImageHeader header;
  std::string line;
  for (int n = 0; n < kMaxMetaImageLines && std::getline(stream, line); ++n) {
    const std::size_t separator = line.find_first_of("=:");
    if (separator == std::string::npos) continue;
    const std::string key(trimmed(std::string_view(line).substr(0, separator)));
    header.fields[key] = trimmed(std::string_view(line).substr(separator + 1));
    if (key == "ElementDataFile") break;  // It is the last field.
  }
  header.end = stream ? static_cast<std::uint64_t>(stream.tellg()) : 0;
  return header;
}

/// Returns the direction of the axes i, j, k as letters: R or L, A or P, I or S.
std::string letters_towards(const Mat3& direction) {
  constexpr std::array<std::array<char, 2>, 3> kLetters{{{'R', 'L'}, {'A', 'P'}, {'I', 'S'}}};
  std::string letters;
  for (Index axis = 0; axis < 3; ++axis) {
    Index main = 0;
    direction.col(axis).cwiseAbs().maxCoeff(&main);
    letters += kLetters[static_cast<std::size_t>(main)][direction(main, axis) > 0.0 ? 1 : 0];
  }
  return letters;
}

std::string opposite(std::string letters) {
  constexpr std::string_view kPairs = "RLAPIS";
  for (char& letter : letters) letter = kPairs[kPairs.find(letter) ^ 1U];
  return letters;
}

/// Checks that the header states the orientation of the voxels consistently.
Result<void> check_orientation(const MetaImageHeader& header, const Mat3& direction) {
  if (!header.has_one_of({"TransformMatrix", "Rotation", "Orientation"}))
    return tl::unexpected(unsupported(
        "the header has no TransformMatrix, expected one so that left and right are known"));
  if (!header.has_one_of({"ElementSpacing", "ElementSize"}))
    return tl::unexpected(unsupported("the header has no ElementSpacing, expected one"));
  if (const std::string unit = header.field("DistanceUnits");
      !unit.empty() && unit != "mm" && unit != "?")
    return tl::unexpected(unsupported("DistanceUnits is not mm, expected mm"));
  // The letters of MetaIO state where the axes start, those of some writers where they end.
  const std::string stated = header.field("AnatomicalOrientation");
  const std::string towards = letters_towards(direction);
  if (!stated.empty() && stated.find('?') == std::string::npos && stated != towards &&
      stated != opposite(towards))
    return fail(ErrorCode::kFileCorrupt,
                "AnatomicalOrientation contradicts TransformMatrix, expected the same orientation");
  return {};
}

/// Compressed and uncompressed size of a zlib stream.
struct ZlibStream {
  std::uint64_t packed, unpacked;
};

/// Nothing if the stream is damaged or has more than `maximum` bytes uncompressed.
std::optional<ZlibStream> unpack_once(std::ifstream& stream, std::uint64_t maximum) {
  z_stream zip{};
  if (inflateInit2(&zip, 15 + 32) != Z_OK) return std::nullopt;  // zlib or gzip.
  const std::unique_ptr<z_stream, int (*)(z_stream*)> cleanup(&zip, inflateEnd);
  std::vector<char> packed(kMetaImageChunk), unpacked(kMetaImageChunk);
  for (int state = Z_OK; state != Z_STREAM_END;) {
    if (zip.avail_in == 0) {
      stream.read(packed.data(), std::streamsize(kMetaImageChunk));
      zip.next_in = reinterpret_cast<Bytef*>(packed.data());
      zip.avail_in = static_cast<uInt>(stream.gcount());
      if (zip.avail_in == 0) return std::nullopt;
    }
    zip.next_out = reinterpret_cast<Bytef*>(unpacked.data());
    zip.avail_out = static_cast<uInt>(kMetaImageChunk);
    state = inflate(&zip, Z_NO_FLUSH);
    if (state != Z_OK && state != Z_STREAM_END) return std::nullopt;
    if (zip.total_out > maximum) return std::nullopt;
  }
  return ZlibStream{zip.total_in, zip.total_out};
}

/// Returns the number of bytes before the voxels of a voxel file.
Result<std::uint64_t> skipped_bytes(const MetaImageHeader& header, bool is_detached) {
  const std::string text = header.field("HeaderSize");
  if (text.empty() || text == "0") return 0;
  std::uint64_t bytes = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, bytes);
  if (error != std::errc() || rest != end || !is_detached || header.is_true("CompressedData"))
    return tl::unexpected(unsupported(
        "HeaderSize is not 0, expected 0 unless uncompressed voxels are in a separate file"));
  return bytes;
}

}  // namespace

Result<void> check_metaimage(const fs::path& file, std::uint64_t bytes, const Mat3& direction) {
  std::ifstream stream(file, std::ios::binary);
  MetaImageHeader header = read_header(stream);
  LEFORT_TRY_VOID(check_orientation(header, direction));
  if (header.fields.contains("BinaryData") && !header.is_true("BinaryData"))
    return tl::unexpected(unsupported("the voxels are text, expected binary"));

  const std::string where = header.field("ElementDataFile");
  const bool is_detached = where != "LOCAL" && where != "Local" && where != "local";
  LEFORT_TRY(const std::uint64_t skipped, skipped_bytes(header, is_detached));
  fs::path voxel_file = file;
  if (is_detached) {
    LEFORT_TRY(voxel_file, sibling_file(file, where));
    stream = std::ifstream(voxel_file, std::ios::binary);
    header.end = skipped;
  }
  std::error_code error;
  const std::uint64_t size = fs::file_size(voxel_file, error);
  const std::uint64_t stored = error || size < header.end ? 0 : size - header.end;
  if (!header.is_true("CompressedData")) {
    if (stored < bytes) return tl::unexpected(missing_voxels(stored, bytes));
    return {};
  }
  const std::string packed_size = header.field("CompressedDataSize");
  if (packed_size.empty() && !is_detached)  // MetaIO would decompress from the header.
    return tl::unexpected(unsupported("the header has no CompressedDataSize, expected one"));
  const std::optional<ZlibStream> zlib = unpack_once(stream, bytes);
  // MetaIO returns zeros if bytes follow the stream.
  if ((!packed_size.empty() && packed_size != std::to_string(stored)) || !zlib ||
      zlib->packed != stored || zlib->unpacked != bytes)
    return fail(ErrorCode::kFileCorrupt, "the compressed voxels are truncated or damaged");
  return {};
}

}  // namespace lefort::io
