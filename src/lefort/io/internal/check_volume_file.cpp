#include <lefort/io/internal/check_volume_file.h>

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lefort::io {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t kChunk = 1 << 20;
constexpr int kMaxLines = 10'000;  // Of a text header.
constexpr std::uint64_t kMaxBytes = std::uint64_t{1} << 40;

Error cut_off(std::uint64_t found, std::uint64_t wanted) {
  return {ErrorCode::kFileCorrupt,
          fmt::format("there are {} bytes of voxels, expected {}", found, wanted)};
}

/// The first bytes of a NIfTI-1 file; the numbers are where nifti1.h has them.
class NiftiHeader {
 public:
  static constexpr std::size_t kSize = 348;

  explicit NiftiHeader(const std::array<char, kSize>& bytes) : bytes_(bytes) {
    swapped_ = number<std::int32_t>(0) != std::int32_t{kSize};
  }

  [[nodiscard]] bool is_valid() const {
    return number<std::int32_t>(0) == std::int32_t{kSize} &&
           std::string_view(bytes_.data() + 344, 4) == std::string_view("n+1\0", 4);
  }
  [[nodiscard]] std::int16_t datatype() const { return number<std::int16_t>(70); }
  [[nodiscard]] bool has_orientation() const {  // qform_code, sform_code
    return number<std::int16_t>(252) > 0 || number<std::int16_t>(254) > 0;
  }
  [[nodiscard]] double voxel_offset() const { return static_cast<double>(number<float>(108)); }

  /// Voxels along all dimensions; nothing when they make no sense.
  [[nodiscard]] std::optional<std::uint64_t> voxel_count() const {
    const std::int16_t dimensions = number<std::int16_t>(40);
    if (dimensions < 1 || dimensions > 7) return std::nullopt;
    std::uint64_t count = 1;
    for (std::size_t d = 1; d <= static_cast<std::size_t>(dimensions); ++d) {
      const std::int16_t size = number<std::int16_t>(40 + 2 * d);
      if (size < 1) return std::nullopt;
      count *= static_cast<std::uint64_t>(size);
      if (count > kMaxBytes) return std::nullopt;
    }
    return count;
  }

 private:
  template <class T>
  [[nodiscard]] T number(std::size_t at) const {
    std::array<char, sizeof(T)> cell;
    std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(at), sizeof(T), cell.begin());
    if (swapped_) std::reverse(cell.begin(), cell.end());
    T value;
    std::memcpy(&value, cell.data(), sizeof(T));
    return value;
  }

  std::array<char, kSize> bytes_;
  bool swapped_ = false;
};

/// Bytes of one voxel, 0 for types that are no plain numbers.
std::uint64_t nifti_voxel_bytes(std::int16_t datatype) {
  switch (datatype) {
    case 2:
    case 256:
      return 1;  // clang-format off
    case 4: case 512: return 2;
    case 8: case 16: case 768: return 4;
    case 64: case 1024: case 1280: return 8;
    default: return 0;
  }  // clang-format on
}

/// Text fields of a MetaImage header; the voxels, if they follow, start at `end`.
struct MetaImageHeader {
  std::map<std::string, std::string> fields;
  std::uint64_t end = 0;
};

MetaImageHeader read_metaimage_header(std::ifstream& stream) {
  const auto trimmed = [](std::string text) {
    text.erase(text.find_last_not_of(" \t\r") + 1);
    text.erase(0, text.find_first_not_of(" \t"));
    return text;
  };
  MetaImageHeader header;
  std::string line;
  for (int n = 0; n < kMaxLines && std::getline(stream, line); ++n) {
    const std::size_t equals = line.find('=');
    if (equals == std::string::npos) continue;
    const std::string key = trimmed(line.substr(0, equals));
    header.fields[key] = trimmed(line.substr(equals + 1));
    if (key == "ElementDataFile") break;  // It is the last field.
  }
  header.end = stream ? static_cast<std::uint64_t>(stream.tellg()) : 0;
  return header;
}

/// How many bytes a zlib stream unpacks to; nothing when it is damaged or more than `most`.
std::optional<std::uint64_t> unpacked_bytes(std::ifstream& stream, std::uint64_t most) {
  z_stream zip{};
  if (inflateInit2(&zip, 15 + 32) != Z_OK) return std::nullopt;  // zlib or gzip.
  const std::unique_ptr<z_stream, int (*)(z_stream*)> cleanup(&zip, inflateEnd);
  std::vector<char> packed(kChunk), unpacked(kChunk);
  std::uint64_t total = 0;
  for (int state = Z_OK; state != Z_STREAM_END;) {
    if (zip.avail_in == 0) {
      stream.read(packed.data(), std::streamsize(kChunk));
      zip.next_in = reinterpret_cast<Bytef*>(packed.data());
      zip.avail_in = static_cast<uInt>(stream.gcount());
      if (zip.avail_in == 0) return std::nullopt;
    }
    zip.next_out = reinterpret_cast<Bytef*>(unpacked.data());
    zip.avail_out = static_cast<uInt>(kChunk);
    state = inflate(&zip, Z_NO_FLUSH);
    if (state != Z_OK && state != Z_STREAM_END) return std::nullopt;
    total += kChunk - zip.avail_out;
    if (total > most) return std::nullopt;
  }
  return total;
}

}  // namespace

Result<void> check_nifti(const fs::path& file) {
  const std::unique_ptr<gzFile_s, int (*)(gzFile)> stream(gzopen(file.c_str(), "rb"), gzclose);
  std::array<char, NiftiHeader::kSize> start{};
  if (stream == nullptr || gzread(stream.get(), start.data(), NiftiHeader::kSize) !=
                               static_cast<int>(NiftiHeader::kSize))
    return fail(ErrorCode::kFileCorrupt, "there is no whole header, expected that of a NIfTI file");
  const NiftiHeader header(start);
  const std::optional<std::uint64_t> voxels = header.voxel_count();
  const double offset = header.voxel_offset();
  if (!header.is_valid() || !voxels || !(offset >= 0.0 && offset <= 1e9))
    return fail(ErrorCode::kFileCorrupt, "the header is damaged, expected that of a NIfTI file");
  const std::uint64_t voxel_bytes = nifti_voxel_bytes(header.datatype());
  if (voxel_bytes == 0)
    return fail(
        ErrorCode::kFileUnsupported,
        fmt::format("the voxels are of NIfTI type {}, expected plain numbers", header.datatype()));

  if (!header.has_orientation())
    return fail(ErrorCode::kFileUnsupported,
                "the qform and sform codes are 0, expected one that says where left and right are");

  const std::uint64_t wanted = static_cast<std::uint64_t>(offset) + *voxels * voxel_bytes;
  std::vector<char> chunk(kChunk);
  std::uint64_t found = NiftiHeader::kSize;
  while (found < wanted) {
    const int got = gzread(stream.get(), chunk.data(), static_cast<unsigned>(chunk.size()));
    if (got <= 0) return tl::unexpected(cut_off(found, wanted));
    found += static_cast<std::uint64_t>(got);
  }
  // One step to the end of a gzip stream, where zlib compares the checksum.
  if (gzread(stream.get(), chunk.data(), static_cast<unsigned>(chunk.size())) < 0)
    return fail(ErrorCode::kFileCorrupt, "the compressed voxels are damaged");
  return {};
}

Result<void> check_nrrd(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string line, space;
  for (int n = 0; n < kMaxLines && std::getline(stream, line); ++n) {
    if (line.ends_with('\r')) line.pop_back();
    if (line.empty()) break;  // The voxels follow.
    for (char& c : line) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (line.starts_with("space: ")) space = line.substr(7);
  }
  if (space == "left-posterior-superior" || space == "lps" || space == "right-anterior-superior" ||
      space == "ras")
    return {};
  return fail(ErrorCode::kFileUnsupported,
              "the header has no field space that is LPS or RAS, expected one so that left and "
              "right are known");
}

Result<void> check_metaimage(const fs::path& file, std::uint64_t bytes) {
  std::ifstream stream(file, std::ios::binary);
  MetaImageHeader header = read_metaimage_header(stream);
  const std::string where = header.fields["ElementDataFile"];
  if (where.empty() || where.starts_with("LIST") || where.find('%') != std::string::npos)
    return fail(ErrorCode::kFileUnsupported,
                "the voxels are spread over several files, expected one");
  fs::path voxel_file = file;
  if (where != "LOCAL" && where != "Local" && where != "local") {
    voxel_file = file.parent_path() / where;
    stream = std::ifstream(voxel_file, std::ios::binary);
    header.end = 0;
  }
  std::error_code error;
  const std::uint64_t size = fs::file_size(voxel_file, error);
  const std::uint64_t stored = error || size < header.end ? 0 : size - header.end;
  const std::string packed = header.fields["CompressedData"];
  if (packed != "True" && packed != "true" && packed != "1") {
    if (stored < bytes) return tl::unexpected(cut_off(stored, bytes));
    return {};
  }
  const std::string packed_size = header.fields["CompressedDataSize"];
  const std::optional<std::uint64_t> unpacked = unpacked_bytes(stream, bytes);
  if ((!packed_size.empty() && packed_size != std::to_string(stored)) || unpacked != bytes)
    return fail(ErrorCode::kFileCorrupt, "the compressed voxels are truncated or damaged");
  return {};
}

}  // namespace lefort::io
