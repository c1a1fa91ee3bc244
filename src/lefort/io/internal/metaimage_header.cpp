#include <lefort/io/internal/header_lines.h>
#include <lefort/io/internal/volume_header.h>

#include <algorithm>
#include <array>
#include <initializer_list>
#include <iterator>
#include <map>
#include <utility>

namespace lefort::io {
namespace fs = std::filesystem;

namespace {

/// The types whose size is the same on all machines; MetaIO's MET_LONG has 4 bytes.
constexpr std::pair<std::string_view, ScalarType> kMetaTypes[] = {
    {"MET_CHAR", ScalarType::kInt8},       {"MET_UCHAR", ScalarType::kUint8},
    {"MET_SHORT", ScalarType::kInt16},     {"MET_USHORT", ScalarType::kUint16},
    {"MET_INT", ScalarType::kInt32},       {"MET_UINT", ScalarType::kUint32},
    {"MET_LONG", ScalarType::kInt32},      {"MET_ULONG", ScalarType::kUint32},
    {"MET_LONG_LONG", ScalarType::kInt64}, {"MET_ULONG_LONG", ScalarType::kUint64},
    {"MET_FLOAT", ScalarType::kFloat},     {"MET_DOUBLE", ScalarType::kDouble},
};

Error unsupported_metaimage(const char* why) { return {ErrorCode::kFileUnsupported, why}; }
Error corrupt_metaimage(const char* why) { return {ErrorCode::kFileCorrupt, why}; }

/// Text fields of a header; voxels in the same file start at `end`.
struct MetaImageText {
  std::map<std::string, std::string, std::less<>> fields;
  std::uint64_t end = 0;

  /// The text of the first field of these names that the header has; empty if it has none.
  [[nodiscard]] std::string_view field(std::initializer_list<const char*> names) const {
    for (const char* name : names)
      if (const auto found = fields.find(name); found != fields.end()) return found->second;
    return {};
  }
  /// As in MetaIO, the first letter decides.
  [[nodiscard]] bool is_true(std::initializer_list<const char*> names) const {
    const std::string_view text = field(names);
    return text.starts_with('T') || text.starts_with('t') || text.starts_with('1');
  }
};

/// Reads the fields up to ElementDataFile, which is the last one.
Result<MetaImageText> read_metaimage_text(const fs::path& file) {
  LEFORT_TRY(HeaderLines lines, HeaderLines::open(file));
  MetaImageText text;
  while (!text.fields.contains("ElementDataFile")) {
    LEFORT_TRY(const auto line, lines.next());
    const std::size_t separator = line ? line->find_first_of("=:") : std::string_view::npos;
    if (!line || separator == std::string_view::npos)
      return tl::unexpected(corrupt_metaimage(
          "the header cannot be read, expected lines \"field = value\" of a MetaImage file"));
    const std::string_view key = trimmed(line->substr(0, separator));
    if (!text.fields.emplace(key, trimmed(line->substr(separator + 1))).second)
      return tl::unexpected(corrupt_metaimage("a field of the header is repeated"));
  }
  text.end = lines.position();
  return text;
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

/// Reads size, spacing, direction and origin, which the header must state consistently.
Result<image::Grid> read_placement(const MetaImageText& text) {
  image::Grid grid;
  if (const auto dimensions = exact_numbers<int>(text.field({"NDims"}), 1); !dimensions)
    return tl::unexpected(corrupt_metaimage("NDims is not a number, expected 3"));
  else if (dimensions->front() != 3)
    return fail(ErrorCode::kFileUnsupported,
                "the image has " + std::to_string(dimensions->front()) + " dimensions, expected 3");
  const std::string_view matrix_text = text.field({"TransformMatrix", "Rotation", "Orientation"});
  if (matrix_text.empty())
    return tl::unexpected(unsupported_metaimage(
        "the header has no TransformMatrix, expected one so that left and right are known"));
  const std::string_view spacing_text = text.field({"ElementSpacing", "ElementSize"});
  if (spacing_text.empty())
    return tl::unexpected(unsupported_metaimage("the header has no ElementSpacing, expected one"));
  const std::string_view unit = text.field({"DistanceUnits"});
  if (!unit.empty() && unit != "mm" && unit != "?")
    return tl::unexpected(unsupported_metaimage("DistanceUnits is not mm, expected mm"));

  const std::string_view origin_text = text.field({"Offset", "Position", "Origin"});
  const auto size = exact_numbers<Index>(text.field({"DimSize"}), 3);
  const auto spacing_mm = exact_numbers<double>(spacing_text, 3);
  const auto matrix = exact_numbers<double>(matrix_text, 9);
  const auto origin_mm = exact_numbers<double>(origin_text.empty() ? "0 0 0" : origin_text, 3);
  if (!size || !spacing_mm || !matrix || !origin_mm)
    return tl::unexpected(corrupt_metaimage(
        "DimSize, ElementSpacing, TransformMatrix and Offset are not 3, 3, 9 and 3 numbers"));
  std::copy_n(size->begin(), 3, grid.size.begin());
  for (Index axis = 0; axis < 3; ++axis) {
    grid.spacing_mm[axis] = (*spacing_mm)[std::size_t(axis)];
    grid.origin_L[axis] = (*origin_mm)[std::size_t(axis)];
    for (Index row = 0; row < 3; ++row)  // A line of the file is the direction of an axis.
      grid.direction(row, axis) = (*matrix)[std::size_t(3 * axis + row)];
  }
  // The letters of MetaIO state where the axes start, those of some writers where they end.
  const std::string_view stated = text.field({"AnatomicalOrientation"});
  const std::string towards = letters_towards(grid.direction);
  if (!stated.empty() && stated.find('?') == std::string_view::npos && stated != towards &&
      stated != opposite(towards))
    return tl::unexpected(corrupt_metaimage(
        "AnatomicalOrientation contradicts TransformMatrix, expected the same orientation"));
  return grid;
}

/// Type and number of the values of a voxel.
Result<void> read_values(const MetaImageText& text, RawVolume& volume) {
  const auto type =
      std::find_if(std::begin(kMetaTypes), std::end(kMetaTypes),
                   [&](const auto& known) { return known.first == text.field({"ElementType"}); });
  if (type == std::end(kMetaTypes))
    return tl::unexpected(
        unsupported_metaimage("the voxels are not numbers, expected an ElementType of numbers"));
  volume.type = type->second;
  if (const auto channels = text.field({"ElementNumberOfChannels"}); !channels.empty()) {
    const auto count = exact_numbers<Index>(channels, 1);
    if (!count) return tl::unexpected(corrupt_metaimage("ElementNumberOfChannels is not a number"));
    volume.components = count->front();
  }
  const auto is_number = [&](const char* name, double wanted) {
    const std::string_view stated = text.field({name});
    const auto number = exact_numbers<double>(stated, 1);
    return stated.empty() || (number && number->front() == wanted);
  };
  // MetaIO states these and does not apply them.
  if (!is_number("ElementToIntensityFunctionSlope", 1.0) ||
      !is_number("ElementToIntensityFunctionOffset", 0.0))
    return tl::unexpected(
        unsupported_metaimage("the voxels are to be rescaled, expected values without a scale"));
  return {};
}

Result<VoxelStorage> read_storage(const fs::path& file, const MetaImageText& text) {
  VoxelStorage storage;
  if (!text.field({"BinaryData"}).empty() && !text.is_true({"BinaryData"}))
    return tl::unexpected(unsupported_metaimage("the voxels are text, expected binary"));
  storage.is_big_endian = text.is_true({"BinaryDataByteOrderMSB", "ElementByteOrderMSB"});
  const bool is_packed = text.is_true({"CompressedData"});
  if (is_packed) storage.encoding = VoxelEncoding::kDeflated;
  storage.is_one_stream = true;

  const std::string_view where = text.field({"ElementDataFile"});
  const bool is_detached = where != "LOCAL" && where != "Local" && where != "local";
  const std::string_view skip_text = text.field({"HeaderSize"});
  const auto skipped = exact_numbers<std::uint64_t>(skip_text.empty() ? "0" : skip_text, 1);
  if (!skipped || (skipped->front() != 0 && (!is_detached || is_packed)))
    return tl::unexpected(unsupported_metaimage(
        "HeaderSize is not 0, expected 0 unless uncompressed voxels are in a separate file"));
  const std::string_view per_slice = text.field({"HeaderSizePerSlice"});
  if (!per_slice.empty() && per_slice != "0")
    return tl::unexpected(unsupported_metaimage("HeaderSizePerSlice is not 0, expected 0"));
  storage.file = file;
  storage.begin = is_detached ? skipped->front() : text.end;
  if (is_detached) {
    LEFORT_TRY(storage.file, sibling_file(file, where));
  }

  const std::string_view packed_text = text.field({"CompressedDataSize"});
  if (!is_packed) return storage;
  if (packed_text.empty() && !is_detached)
    return tl::unexpected(
        unsupported_metaimage("the header has no CompressedDataSize, expected one"));
  if (packed_text.empty()) return storage;
  const auto packed = exact_numbers<std::uint64_t>(packed_text, 1);
  if (!packed) return tl::unexpected(corrupt_metaimage("CompressedDataSize is not a number"));
  storage.bytes = packed->front();
  return storage;
}

}  // namespace

Result<VolumeHeader> read_metaimage_header(const fs::path& file) {
  LEFORT_TRY(const MetaImageText text, read_metaimage_text(file));
  if (const std::string_view object = text.field({"ObjectType"});
      !object.empty() && object != "Image")
    return tl::unexpected(unsupported_metaimage("ObjectType is not Image, expected Image"));
  VolumeHeader header;
  LEFORT_TRY(header.volume.grid, read_placement(text));
  LEFORT_TRY_VOID(read_values(text, header.volume));
  LEFORT_TRY(header.storage, read_storage(file, text));
  return header;
}

}  // namespace lefort::io
