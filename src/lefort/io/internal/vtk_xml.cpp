#include <lefort/io/internal/surface_formats.h>
#include <lefort/io/internal/vtk_xml.h>

#include <expat.h>
#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <tuple>

namespace lefort::io::internal {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays are read without conversion");

// Upper bound of the compression ratio of zlib.
constexpr std::size_t kMaxZlibRatio = 1100;
// Limit of the size in memory: this, plus so many bytes per byte of the file.
constexpr std::size_t kFreeBytes = std::size_t(64) << 20;
constexpr std::size_t kBytesForOne = 64;
constexpr int kMaxPieces = 1000;
constexpr std::size_t kMaxArrays = 20'000;
constexpr std::size_t kMaxOpenElements = 64;

using Attributes = std::map<std::string, std::string>;

/// Remaining memory budget of all arrays.
class Budget {
 public:
  explicit Budget(std::size_t file_bytes) : left_(kFreeBytes + kBytesForOne * file_bytes) {}
  /// Whether so many more bytes are allowed.
  [[nodiscard]] bool take(std::uint64_t bytes) {
    if (bytes > left_) return false;
    left_ -= bytes;
    return true;
  }

 private:
  std::uint64_t left_;
};

/// A DataArray element of the XML.
struct RawArray {
  Attributes attributes;
  std::string parent;
  int piece = 0;
  std::string text;
};

/// State of the XML parser.
struct Document {
  XML_Parser parser = nullptr;
  Attributes file;  ///< Of the VTKFile element.
  std::vector<RawArray> arrays;
  std::vector<std::string> open;  ///< Open elements.
  int pieces = 0;

  /// Elements of a hostile file are short: without a limit, each costs a hundred times its bytes.
  void stop_if_too_large() const {
    if (arrays.size() > kMaxArrays || open.size() > kMaxOpenElements)
      XML_StopParser(parser, XML_FALSE);
  }
};

Attributes attributes_of(const XML_Char** names_and_values) {
  Attributes attributes;
  for (; *names_and_values != nullptr; names_and_values += 2)
    attributes[names_and_values[0]] = names_and_values[1];
  return attributes;
}

void on_start(void* data, const XML_Char* name, const XML_Char** attributes) {
  auto& document = *static_cast<Document*>(data);
  const std::string element = name;
  if (element == "VTKFile" && document.open.empty()) document.file = attributes_of(attributes);
  if (element == "Piece") ++document.pieces;
  if ((element == "DataArray" || element == "Array") && !document.open.empty())
    document.arrays.push_back(
        {attributes_of(attributes), document.open.back(), document.pieces, {}});
  document.open.push_back(element);
  document.stop_if_too_large();
}

/// VTK's files have no document type. Entities, which only it can declare, expand small files to
/// large texts, and expat 2.5 calls itself for each that is inside another (CVE-2024-8176).
void on_doctype(void* data, const XML_Char*, const XML_Char*, const XML_Char*, int) {
  XML_StopParser(static_cast<Document*>(data)->parser, XML_FALSE);
}

void on_end(void* data, const XML_Char* /*name*/) { static_cast<Document*>(data)->open.pop_back(); }

void on_text(void* data, const XML_Char* text, int length) {
  auto& document = *static_cast<Document*>(data);
  const bool in_array =
      !document.open.empty() && !document.arrays.empty() && document.open.back().ends_with("Array");
  if (in_array) document.arrays.back().text.append(text, std::size_t(length));
}

/// Parses the XML up to the appended data, which is not XML; nothing if it is not well-formed.
std::optional<Document> parse_document(std::string_view xml) {
  const std::unique_ptr<XML_ParserStruct, void (*)(XML_Parser)> parser(XML_ParserCreate(nullptr),
                                                                       XML_ParserFree);
  Document document;
  document.parser = parser.get();
  XML_SetUserData(parser.get(), &document);
  XML_SetStartDoctypeDeclHandler(parser.get(), on_doctype);
  XML_SetElementHandler(parser.get(), on_start, on_end);
  XML_SetCharacterDataHandler(parser.get(), on_text);
  constexpr std::size_t kChunk = std::size_t(1) << 28;  // expat counts in int.
  for (std::string_view rest = xml; !rest.empty();) {
    const std::string_view chunk = rest.substr(0, kChunk);
    if (XML_Parse(parser.get(), chunk.data(), int(chunk.size()), XML_FALSE) != XML_STATUS_OK)
      return {};
    rest.remove_prefix(chunk.size());
  }
  return document;
}

/// Returns the value of a base64 digit; -1 for other characters.
int base64_value(char c) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const std::size_t value = kDigits.find(c);
  return value == std::string_view::npos ? -1 : int(value);
}

/// Decodes up to the first padding and removes the decoded groups of four from `text`.
std::string take_base64(std::string_view& text) {
  std::string bytes;
  unsigned bits = 0;
  int held = 0;
  std::size_t digits = 0;
  std::size_t at = 0;
  for (; at < text.size(); ++at) {
    const char c = text[at];
    if (c == ' ' || c == '\n' || c == '\r' || c == '\t') continue;
    if (c == '=') break;
    const int value = base64_value(c);
    if (value < 0) break;
    ++digits;
    bits = (bits << 6U) | unsigned(value);
    held += 6;
    if (held < 8) continue;
    held -= 8;
    bytes += char((bits >> unsigned(held)) & 0xFFU);
  }
  while (at < text.size() && text[at] == '=' && digits % 4 != 0) {
    ++at;
    ++digits;
  }
  text.remove_prefix(at);
  return bytes;
}

/// Sizes at the beginning of the data.
struct Sizes {
  std::size_t width = 4;  ///< Bytes per number.
  [[nodiscard]] std::optional<std::uint64_t> at(std::string_view bytes, std::size_t n) const {
    if ((n + 1) * width > bytes.size()) return {};
    std::uint64_t value = 0;
    std::memcpy(&value, bytes.data() + n * width, width);
    return value;
  }
};

/// Decompresses and joins the blocks of an array. The sizes are block count, bytes per block, bytes
/// of the last block, and the compressed bytes of every block.
std::optional<std::string> inflated(std::string_view sizes_bytes, std::string_view data,
                                    const Sizes& sizes, Budget& budget) {
  const auto blocks = sizes.at(sizes_bytes, 0);
  const auto block_bytes = sizes.at(sizes_bytes, 1);
  const auto last_bytes = sizes.at(sizes_bytes, 2);
  if (!blocks || !block_bytes || !last_bytes) return {};
  std::string result;
  for (std::uint64_t block = 0; block < *blocks; ++block) {
    const auto packed = sizes.at(sizes_bytes, std::size_t(3 + block));
    if (!packed || *packed > data.size()) return {};
    const bool is_short = block + 1 == *blocks && *last_bytes != 0;
    const std::uint64_t size = is_short ? *last_bytes : *block_bytes;
    if (size > (*packed + 1) * kMaxZlibRatio || !budget.take(size)) return {};
    const std::size_t begin = result.size();
    result.resize(begin + std::size_t(size));
    uLongf written = uLongf(size);
    if (uncompress(reinterpret_cast<Bytef*>(result.data() + begin), &written,
                   reinterpret_cast<const Bytef*>(data.data()), uLong(*packed)) != Z_OK ||
        written != size)
      return {};
    data.remove_prefix(std::size_t(*packed));
  }
  return result;
}

/// Encoding of the bytes of an array.
struct Packing {
  Sizes sizes;
  bool is_compressed = false;
  bool is_base64 = false;
};

/// Number of bytes of the sizes before a compressed array, according to its own block count.
std::optional<std::size_t> sizes_length(std::string_view bytes, const Sizes& sizes) {
  const auto blocks = sizes.at(bytes, 0);
  if (!blocks || *blocks > bytes.size() * kMaxZlibRatio) return {};
  return (std::size_t(*blocks) + 3) * sizes.width;
}

std::optional<std::string> unpacked(std::string_view packed, const Packing& packing,
                                    Budget& budget) {
  std::string decoded;
  if (packing.is_base64) {
    // Sizes and data are encoded separately or, without compression, together.
    decoded = take_base64(packed);
    const auto length = packing.is_compressed ? sizes_length(decoded, packing.sizes)
                                              : std::optional(packing.sizes.width);
    if (length && decoded.size() == *length) decoded += take_base64(packed);
    packed = decoded;
  }
  if (packing.is_compressed) {
    const auto length = sizes_length(packed, packing.sizes);
    if (!length || *length > packed.size()) return {};
    return inflated(packed.substr(0, *length), packed.substr(*length), packing.sizes, budget);
  }
  const auto bytes = packing.sizes.at(packed, 0);
  if (!bytes || *bytes > packed.size() - packing.sizes.width || !budget.take(*bytes)) return {};
  return std::string(packed.substr(packing.sizes.width, std::size_t(*bytes)));
}

template <class T>
std::optional<std::vector<double>> numbers_as(std::string_view bytes, Budget& budget) {
  if (bytes.size() % sizeof(T) != 0 || !budget.take(bytes.size() / sizeof(T) * sizeof(double)))
    return {};
  std::vector<double> numbers(bytes.size() / sizeof(T));
  for (std::size_t n = 0; n < numbers.size(); ++n) {
    T value;
    std::memcpy(&value, bytes.data() + n * sizeof(T), sizeof(T));
    numbers[n] = double(value);
  }
  return numbers;
}

std::optional<std::vector<double>> numbers_from_bytes(std::string_view bytes,
                                                      const std::string& type, Budget& budget) {
  if (type == "Float32") return numbers_as<float>(bytes, budget);
  if (type == "Float64") return numbers_as<double>(bytes, budget);
  if (type == "Int8") return numbers_as<std::int8_t>(bytes, budget);
  if (type == "UInt8" || type == "String") return numbers_as<std::uint8_t>(bytes, budget);
  if (type == "Int16") return numbers_as<std::int16_t>(bytes, budget);
  if (type == "UInt16") return numbers_as<std::uint16_t>(bytes, budget);
  if (type == "Int32") return numbers_as<std::int32_t>(bytes, budget);
  if (type == "UInt32") return numbers_as<std::uint32_t>(bytes, budget);
  if (type == "Int64") return numbers_as<std::int64_t>(bytes, budget);
  if (type == "UInt64") return numbers_as<std::uint64_t>(bytes, budget);
  return {};
}

std::optional<std::vector<double>> numbers_from_text(std::string_view text) {
  std::vector<double> numbers;
  for (std::string_view word = take_word(text); !word.empty(); word = take_word(text))
    if (!parse_number(word, numbers.emplace_back())) return {};
  return numbers;
}

std::string value_of(const Attributes& attributes, const char* name) {
  const auto found = attributes.find(name);
  return found == attributes.end() ? std::string() : found->second;
}

/// Finds the data after the XML, whose attributes state the encoding.
struct Appended {
  std::string_view bytes;
  bool is_base64 = false;
};

Appended find_appended(std::string_view bytes, std::size_t at) {
  if (at == std::string_view::npos) return {};
  const std::string_view rest = bytes.substr(at);
  const std::size_t tag_end = std::min(rest.find('>'), rest.size());
  const std::size_t begin = rest.find('_', tag_end);
  return {begin == std::string_view::npos ? std::string_view() : rest.substr(begin + 1),
          rest.substr(0, tag_end).find("base64") != std::string_view::npos};
}

std::optional<std::vector<double>> decode(const RawArray& array, Packing packing,
                                          const Appended& appended, Budget& budget) {
  const std::string format = value_of(array.attributes, "format");
  const std::string type = value_of(array.attributes, "type");
  if (format == "ascii") return numbers_from_text(array.text);
  std::string_view packed = array.text;
  packing.is_base64 = true;
  if (format == "appended") {
    double offset = 0.0;
    if (!parse_number(value_of(array.attributes, "offset"), offset) ||
        !(offset >= 0.0 && offset <= double(appended.bytes.size())))
      return {};
    packed = appended.bytes.substr(std::size_t(offset));
    packing.is_base64 = appended.is_base64;
  }
  const auto bytes = unpacked(packed, packing, budget);
  if (!bytes) return {};
  return numbers_from_bytes(*bytes, type, budget);
}

/// Piece, parent and name; only one array of each is read.
using ArrayKey = std::tuple<int, std::string, std::string>;

/// Whether `array` is required and the first of its name; if so, marks it as read.
bool is_wanted(const RawArray& array, const std::vector<WantedArray>& wanted,
               std::set<ArrayKey>& taken) {
  const std::string name = value_of(array.attributes, "Name");
  return std::any_of(wanted.begin(), wanted.end(), [&](const WantedArray& want) {
    const bool fits = want.match == NameMatch::kBeginning ? name.starts_with(want.name)
                                                          : want.name.empty() || want.name == name;
    return want.parent == array.parent && fits &&
           taken.emplace(array.piece, want.parent, want.name.empty() ? "" : name).second;
  });
}

}  // namespace

const std::vector<double>* find_array(const XmlArrays& file, int piece, std::string_view parent,
                                      std::string_view name) {
  for (const XmlArray& array : file.arrays)
    if (array.piece == piece && array.parent == parent && (name.empty() || array.name == name))
      return &array.values;
  return nullptr;
}

Result<XmlArrays> parse_vtk_xml(std::string_view bytes, const std::string& name,
                                const std::string& type, const std::vector<WantedArray>& wanted) {
  const auto corrupt = [&](std::string_view why) {
    return fail(ErrorCode::kFileCorrupt, fmt::format("{}: {}", name, why));
  };
  const std::size_t appended_at = bytes.find("<AppendedData");
  const auto document = parse_document(bytes.substr(0, appended_at));
  if (!document || value_of(document->file, "type") != type)
    return corrupt(fmt::format("not a VTK XML file of type {}, or damaged", type));
  if (appended_at == std::string_view::npos && !document->open.empty())
    return corrupt("the file is truncated");

  const std::string compressor = value_of(document->file, "compressor");
  if (!compressor.empty() && compressor != "vtkZLibDataCompressor")
    return fail(ErrorCode::kFileUnsupported,
                fmt::format("{} is compressed with {}, only zlib is supported", name, compressor));
  if (value_of(document->file, "byte_order") == "BigEndian")
    return fail(ErrorCode::kFileUnsupported,
                fmt::format("{} is big-endian, only little-endian is supported", name));
  Packing packing;
  packing.sizes.width = value_of(document->file, "header_type") == "UInt64" ? 8 : 4;
  packing.is_compressed = !compressor.empty();

  const Appended appended = find_appended(bytes, appended_at);
  XmlArrays result{{}, document->pieces};
  if (result.pieces > kMaxPieces)
    return corrupt(
        fmt::format("the file has {} pieces, expected at most {}", result.pieces, kMaxPieces));
  Budget budget(bytes.size());
  std::set<std::string> offsets;
  std::set<ArrayKey> taken;
  for (const RawArray& raw : document->arrays) {
    if (!is_wanted(raw, wanted, taken)) continue;
    if (result.arrays.size() == kMaxArrays)
      return corrupt(fmt::format("there are more than {} arrays to read", kMaxArrays));
    const std::string array_name = value_of(raw.attributes, "Name");
    if (value_of(raw.attributes, "format") == "appended" &&
        !offsets.insert(value_of(raw.attributes, "offset")).second)
      return corrupt(fmt::format("array {} has the same data offset as another array", array_name));
    auto values = decode(raw, packing, appended, budget);
    if (!values)
      return corrupt(fmt::format("array {} is damaged, truncated or far too long", array_name));
    result.arrays.push_back({raw.parent, array_name, raw.piece, std::move(*values)});
  }
  return result;
}

}  // namespace lefort::io::internal
