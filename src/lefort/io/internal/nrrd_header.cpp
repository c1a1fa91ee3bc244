#include <lefort/io/internal/header_lines.h>
#include <lefort/io/internal/volume_header.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

namespace lefort::io {
namespace fs = std::filesystem;

namespace {

using Texts = std::map<std::string, std::string>;

/// The fields of the format, without spaces, which are optional ("data file", "datafile").
constexpr std::array<std::string_view, 31> kNrrdFields{"axismaxs",
                                                       "axismins",
                                                       "blocksize",
                                                       "byteskip",
                                                       "centerings",
                                                       "centers",
                                                       "content",
                                                       "datafile",
                                                       "dimension",
                                                       "encoding",
                                                       "endian",
                                                       "kinds",
                                                       "labels",
                                                       "lineskip",
                                                       "max",
                                                       "measurementframe",
                                                       "min",
                                                       "number",
                                                       "oldmax",
                                                       "oldmin",
                                                       "sampleunits",
                                                       "sizes",
                                                       "space",
                                                       "spacedimension",
                                                       "spacedirections",
                                                       "spaceorigin",
                                                       "spaceunits",
                                                       "spacings",
                                                       "thicknesses",
                                                       "type",
                                                       "units"};

constexpr std::pair<std::string_view, ScalarType> kNrrdTypes[] = {
    {"char", ScalarType::kInt8},
    {"signed char", ScalarType::kInt8},
    {"int8", ScalarType::kInt8},
    {"int8_t", ScalarType::kInt8},
    {"uchar", ScalarType::kUint8},
    {"unsigned char", ScalarType::kUint8},
    {"uint8", ScalarType::kUint8},
    {"uint8_t", ScalarType::kUint8},
    {"short", ScalarType::kInt16},
    {"short int", ScalarType::kInt16},
    {"signed short", ScalarType::kInt16},
    {"signed short int", ScalarType::kInt16},
    {"int16", ScalarType::kInt16},
    {"int16_t", ScalarType::kInt16},
    {"ushort", ScalarType::kUint16},
    {"unsigned short", ScalarType::kUint16},
    {"unsigned short int", ScalarType::kUint16},
    {"uint16", ScalarType::kUint16},
    {"uint16_t", ScalarType::kUint16},
    {"int", ScalarType::kInt32},
    {"signed int", ScalarType::kInt32},
    {"int32", ScalarType::kInt32},
    {"int32_t", ScalarType::kInt32},
    {"uint", ScalarType::kUint32},
    {"unsigned int", ScalarType::kUint32},
    {"uint32", ScalarType::kUint32},
    {"uint32_t", ScalarType::kUint32},
    {"longlong", ScalarType::kInt64},
    {"long long", ScalarType::kInt64},
    {"long long int", ScalarType::kInt64},
    {"signed long long", ScalarType::kInt64},
    {"signed long long int", ScalarType::kInt64},
    {"int64", ScalarType::kInt64},
    {"int64_t", ScalarType::kInt64},
    {"ulonglong", ScalarType::kUint64},
    {"unsigned long long", ScalarType::kUint64},
    {"unsigned long long int", ScalarType::kUint64},
    {"uint64", ScalarType::kUint64},
    {"uint64_t", ScalarType::kUint64},
    {"float", ScalarType::kFloat},
    {"double", ScalarType::kDouble},
};

/// Fields and key/value pairs; voxels in the same file start at `end`.
struct NrrdText {
  Texts fields;
  Texts pairs;
  std::uint64_t end = 0;
  bool is_ended = false;  ///< By an empty line, after which voxels follow.

  [[nodiscard]] std::string_view field(const char* name) const {
    const auto found = fields.find(name);
    return found == fields.end() ? std::string_view() : std::string_view(found->second);
  }
};

/// Replaces "\\n" and "\\\\" by what they stand for.
std::string unescaped(std::string_view text) {
  std::string plain;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const bool is_escape =
        text[at] == '\\' && at + 1 < text.size() && (text[at + 1] == 'n' || text[at + 1] == '\\');
    if (is_escape) ++at;
    plain += is_escape && text[at] == 'n' ? '\n' : text[at];
  }
  return plain;
}

/// Adds the field or pair of a line. \returns false if it is neither, or repeated.
bool add_nrrd_line(std::string_view line, NrrdText& text) {
  const std::size_t colon = line.find(':');
  if (colon == std::string_view::npos || colon == 0) return false;
  const bool is_field = line.substr(colon, 2) == ":" || line.substr(colon, 2) == ": ";
  if (!is_field) {
    const std::size_t equals = line.find(":=");
    if (equals == std::string_view::npos) return false;
    return text.pairs.emplace(unescaped(line.substr(0, equals)), unescaped(line.substr(equals + 2)))
        .second;
  }
  std::string name = in_lower_case(line.substr(0, colon));
  std::erase(name, ' ');
  if (std::find(kNrrdFields.begin(), kNrrdFields.end(), name) == kNrrdFields.end()) return false;
  return text.fields.emplace(name, trimmed(line.substr(colon + 1))).second;
}

Result<NrrdText> read_nrrd_text(const fs::path& file) {
  LEFORT_TRY(HeaderLines lines, HeaderLines::open(file));
  LEFORT_TRY(const auto magic, lines.next());
  if (!magic || magic->size() != 8 || !magic->starts_with("NRRD000") || magic->back() < '1' ||
      magic->back() > '5')
    return fail(ErrorCode::kFileCorrupt, "the header cannot be read, expected that of a NRRD file");
  NrrdText text;
  while (true) {
    LEFORT_TRY(const auto line, lines.next());
    if (!line) break;
    text.is_ended = line->empty();
    if (text.is_ended) break;
    if (line->starts_with('#')) continue;
    if (!add_nrrd_line(*line, text))
      return fail(ErrorCode::kFileCorrupt,
                  fmt::format("line {} of the header is not a field of the format or is repeated",
                              lines.number()));
  }
  text.end = lines.position();
  return text;
}

/// Whether all units are mm; quotes are optional.
bool are_mm(std::string units) {
  std::replace(units.begin(), units.end(), '"', ' ');
  std::string_view rest = units;
  for (std::string_view unit = internal::take_word(rest); !unit.empty();
       unit = internal::take_word(rest))
    if (in_lower_case(unit) != "mm") return false;
  return true;
}

/// Takes "(x,y,z)" from the front of `text`; nothing if there is no such vector.
std::optional<Vec3> take_vector(std::string_view& text) {
  text.remove_prefix(std::min(text.find_first_not_of(" \t"), text.size()));
  const std::size_t end = text.find(')');
  if (!text.starts_with('(') || end == std::string_view::npos) return std::nullopt;
  std::string numbers(text.substr(1, end - 1));
  if (std::count(numbers.begin(), numbers.end(), ',') != 2) return std::nullopt;
  std::replace(numbers.begin(), numbers.end(), ',', ' ');
  text.remove_prefix(end + 1);
  const auto vector = exact_numbers<double>(numbers, 3);
  if (!vector) return std::nullopt;
  return Vec3((*vector)[0], (*vector)[1], (*vector)[2]);
}

/// Spacing, direction and origin. The arithmetic is that of NrrdIO: files that were read with it
/// give the same grid.
Result<void> read_placement(const NrrdText& text, bool has_layers, image::Grid& grid) {
  const std::string space = in_lower_case(text.field("space"));
  const bool is_ras = space == "right-anterior-superior" || space == "ras";
  if (!is_ras && space != "left-posterior-superior" && space != "lps")
    return fail(
        ErrorCode::kFileUnsupported,
        "the header has no space LPS or RAS, expected one so that left and right are known");
  std::string_view directions = text.field("spacedirections");
  if (directions.empty())
    return fail(ErrorCode::kFileUnsupported,
                "the header has no space directions, expected them so that left and right are "
                "known");
  if (!are_mm(std::string(text.field("spaceunits"))))
    return fail(ErrorCode::kFileUnsupported, "the space units are not mm, expected mm");
  if (has_layers) static_cast<void>(internal::take_word(directions));  // "none"
  for (Index axis = 0; axis < 3; ++axis) {
    const auto vector = take_vector(directions);
    if (!vector) return fail(ErrorCode::kFileCorrupt, "the space directions are not three vectors");
    const double spacing_mm = std::sqrt((*vector)[0] * (*vector)[0] + (*vector)[1] * (*vector)[1] +
                                        (*vector)[2] * (*vector)[2]);
    grid.spacing_mm[axis] = spacing_mm;
    grid.direction.col(axis) = *vector * (1.0 / spacing_mm);
  }
  if (!trimmed(directions).empty())
    return fail(ErrorCode::kFileCorrupt, "the space directions are not three vectors");
  if (std::string_view origin = text.field("spaceorigin"); !origin.empty()) {
    const auto vector = take_vector(origin);
    if (!vector || !trimmed(origin).empty())
      return fail(ErrorCode::kFileCorrupt, "the space origin is not a vector");
    grid.origin_L = *vector;
  }
  if (is_ras) {
    grid.direction.topRows<2>() *= -1.0;
    grid.origin_L.head<2>() *= -1.0;
  }
  return {};
}

/// Type, sizes and components.
Result<void> read_shape(const NrrdText& text, RawVolume& volume, bool& has_layers) {
  const auto type = std::find_if(std::begin(kNrrdTypes), std::end(kNrrdTypes),
                                 [name = in_lower_case(text.field("type"))](const auto& known) {
                                   return known.first == name;
                                 });
  if (type == std::end(kNrrdTypes))
    return fail(ErrorCode::kFileUnsupported, "the voxels are not numbers, expected numbers");
  volume.type = type->second;
  const auto dimension = exact_numbers<int>(text.field("dimension"), 1);
  if (!dimension || dimension->front() < 1 || dimension->front() > 16)
    return fail(ErrorCode::kFileCorrupt, "the header has no dimension, expected 3");
  // A first axis without direction counts the values of a voxel.
  has_layers =
      dimension->front() == 4 && in_lower_case(text.field("spacedirections")).starts_with("none");
  if (dimension->front() != 3 && !has_layers)
    return fail(ErrorCode::kFileUnsupported,
                fmt::format("the image has {} dimensions, expected 3", dimension->front()));
  const auto sizes =
      exact_numbers<Index>(text.field("sizes"), static_cast<std::size_t>(dimension->front()));
  if (!sizes)
    return fail(ErrorCode::kFileCorrupt,
                fmt::format("the sizes are not {} whole numbers", dimension->front()));
  if (has_layers) volume.components = sizes->front();
  std::copy_n(sizes->end() - 3, 3, volume.grid.size.begin());
  return {};
}

/// File, position and encoding of the voxels.
Result<VoxelStorage> read_storage(const fs::path& file, const NrrdText& text, bool is_one_byte) {
  VoxelStorage storage;
  storage.file = file;
  storage.begin = text.end;
  if (const std::string_view name = text.field("datafile"); !name.empty()) {
    LEFORT_TRY(storage.file, sibling_file(file, name));
    storage.begin = 0;
  } else if (!text.is_ended) {
    return fail(ErrorCode::kFileCorrupt, "the header has no end, expected an empty line");
  }
  const std::string encoding = in_lower_case(text.field("encoding"));
  if (encoding == "gzip" || encoding == "gz") {
    storage.encoding = VoxelEncoding::kDeflated;
  } else if (encoding == "ascii" || encoding == "text" || encoding == "txt") {
    storage.encoding = VoxelEncoding::kText;
  } else if (encoding != "raw") {
    return fail(ErrorCode::kFileUnsupported,
                "the encoding of the voxels is unknown, expected raw, gzip or ascii");
  }
  const std::string endian = in_lower_case(text.field("endian"));
  storage.is_big_endian = endian == "big";
  if (!storage.is_big_endian && endian != "little" &&
      !(endian.empty() && (is_one_byte || storage.encoding == VoxelEncoding::kText)))
    return fail(ErrorCode::kFileCorrupt, "the header has no endian, expected little or big");
  const auto skipped = [&](const char* name) {
    const std::string_view number = text.field(name);
    return number.empty() ? std::optional(std::vector<std::int64_t>{0})
                          : exact_numbers<std::int64_t>(number, 1);
  };
  const auto lines = skipped("lineskip"), bytes = skipped("byteskip");
  const bool is_raw = storage.encoding == VoxelEncoding::kRaw;
  if (!lines || lines->front() != 0 || !bytes || bytes->front() < -1 ||
      (!is_raw && bytes->front() != 0))
    return fail(ErrorCode::kFileUnsupported,
                "bytes or lines before the voxels are skipped, expected a byte skip of raw voxels");
  storage.is_at_end = bytes->front() == -1;
  if (!storage.is_at_end) storage.begin += static_cast<std::uint64_t>(bytes->front());
  return storage;
}

}  // namespace

Result<VolumeHeader> read_nrrd_header(const fs::path& file) {
  LEFORT_TRY(NrrdText text, read_nrrd_text(file));
  VolumeHeader header;
  bool has_layers = false;
  LEFORT_TRY_VOID(read_shape(text, header.volume, has_layers));
  LEFORT_TRY_VOID(read_placement(text, has_layers, header.volume.grid));
  LEFORT_TRY(header.storage, read_storage(file, text, scalar_bytes(header.volume.type) == 1));
  header.volume.fields = std::move(text.pairs);
  return header;
}

}  // namespace lefort::io
