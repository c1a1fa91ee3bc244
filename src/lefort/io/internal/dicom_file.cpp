#include <lefort/io/internal/dicom_file.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <optional>
#include <utility>

namespace lefort::io {

namespace {

constexpr std::size_t kPreamble = 132;  // 128 free bytes and "DICM".
constexpr std::uint32_t kUndefinedLength = 0xffffffff;
constexpr DicomTag kTransferSyntax = 0x00020010;
constexpr DicomTag kPixelData = 0x7fe00010;
constexpr DicomTag kItem = 0xfffee000;
constexpr DicomTag kItemEnd = 0xfffee00d;
constexpr DicomTag kSequenceEnd = 0xfffee0dd;
constexpr int kMaxSequenceDepth = 32;

/// Encoding of lengths (PS3.5, section 7.1).
enum class Encoding { kExplicit, kImplicit };

struct Element {
  DicomTag tag;
  std::string_view vr;  ///< Two letters, empty if implicit.
  std::uint32_t length;
};

/// Reads forward; every step returns whether the bytes exist.
class Cursor {
 public:
  explicit Cursor(std::string_view bytes) : rest_(bytes) {}

  [[nodiscard]] bool at_end() const { return rest_.empty(); }
  [[nodiscard]] std::string_view rest() const { return rest_; }

  [[nodiscard]] std::optional<std::string_view> take(std::size_t count) {
    if (count > rest_.size()) return std::nullopt;
    const std::string_view taken = rest_.substr(0, count);
    rest_.remove_prefix(count);
    return taken;
  }

  /// Reads a little-endian number.
  template <class T>
  [[nodiscard]] std::optional<T> number() {
    const auto bytes = take(sizeof(T));
    if (!bytes) return std::nullopt;
    T value{};
    std::memcpy(&value, bytes->data(), sizeof(T));
    return value;
  }

  /// Reads tag, value representation and length; nothing if they are truncated.
  [[nodiscard]] std::optional<Element> element(Encoding encoding) {
    const auto group = number<std::uint16_t>();
    const auto within = number<std::uint16_t>();
    if (!within) return std::nullopt;
    const DicomTag tag = (DicomTag{*group} << 16) | *within;
    // Delimiters have no value representation in either encoding.
    if (encoding == Encoding::kExplicit && *group != 0xfffe) return explicit_element(tag);
    const auto length = number<std::uint32_t>();
    if (!length) return std::nullopt;
    return Element{tag, {}, *length};
  }

 private:
  [[nodiscard]] std::optional<Element> explicit_element(DicomTag tag) {
    constexpr std::array<std::string_view, 13> kLong{"OB", "OD", "OF", "OL", "OV", "OW", "SQ",
                                                     "SV", "UC", "UN", "UR", "UT", "UV"};
    const auto vr = take(2);
    if (!vr) return std::nullopt;
    if (std::find(kLong.begin(), kLong.end(), *vr) == kLong.end()) {
      const auto length = number<std::uint16_t>();
      if (!length) return std::nullopt;
      return Element{tag, *vr, *length};
    }
    const auto reserved = number<std::uint16_t>();
    const auto length = number<std::uint32_t>();
    if (!reserved || !length) return std::nullopt;
    return Element{tag, *vr, *length};
  }

  std::string_view rest_;
};

/// Skips the items of a sequence of undefined length and its delimiter.
[[nodiscard]] bool skip_sequence(Cursor& cursor, Encoding encoding, int depth);

/// Skips the elements of an item of undefined length and its delimiter.
bool skip_item(Cursor& cursor, Encoding encoding, int depth) {
  if (depth > kMaxSequenceDepth) return false;
  while (const auto element = cursor.element(encoding)) {
    if (element->tag == kItemEnd) return true;
    if (element->length != kUndefinedLength) {
      if (!cursor.take(element->length)) return false;
      continue;
    }
    // An element of unknown type (UN) and undefined length is a sequence in implicit encoding
    // (PS3.5, 6.2.2).
    const Encoding inner = element->vr == "UN" ? Encoding::kImplicit : encoding;
    if (!skip_sequence(cursor, inner, depth + 1)) return false;
  }
  return false;
}

bool skip_sequence(Cursor& cursor, Encoding encoding, int depth) {
  while (const auto item = cursor.element(encoding)) {
    if (item->tag == kSequenceEnd) return true;
    if (item->tag != kItem) return false;
    const bool whole = item->length == kUndefinedLength ? skip_item(cursor, encoding, depth + 1)
                                                        : cursor.take(item->length).has_value();
    if (!whole) return false;
  }
  return false;
}

Error truncated() { return {ErrorCode::kFileCorrupt, "it is truncated or damaged"}; }

/// The elements of group 2, which are always explicit, define the encoding of the others.
Result<std::string> read_transfer_syntax(Cursor& cursor) {
  std::string syntax;
  while (!cursor.at_end() && cursor.rest().substr(0, 2) == std::string_view("\x02\x00", 2)) {
    const auto element = cursor.element(Encoding::kExplicit);
    const auto value = element ? cursor.take(element->length) : std::nullopt;
    if (!value) return tl::unexpected(truncated());
    if (element->tag == kTransferSyntax) syntax = *value;
  }
  syntax.erase(std::min(syntax.find('\0'), syntax.size()));
  return syntax;
}

DicomElements damaged(DicomElements found, Error why) {
  found.damage = std::move(why);
  return found;
}

/// Other values must not be mistaken for pixels, so any irregularity counts as damage.
DicomElements read_elements(Cursor cursor, Encoding encoding) {
  DicomElements found;
  while (!cursor.at_end()) {
    const auto element = cursor.element(encoding);
    if (!element) return damaged(std::move(found), truncated());
    if (element->length == kUndefinedLength) {
      const std::string_view from_here = cursor.rest();
      const Encoding inner = element->vr == "UN" ? Encoding::kImplicit : encoding;
      if (!skip_sequence(cursor, inner, 0)) return damaged(std::move(found), truncated());
      if (element->tag != kPixelData) continue;
      found.pixels = from_here.substr(0, from_here.size() - cursor.rest().size());
      found.is_compressed = true;
      return found;
    }
    const auto value = cursor.take(element->length);
    if (!value) return damaged(std::move(found), truncated());
    if (element->tag == kPixelData) {
      found.pixels = *value;
      return found;
    }
    found.values.emplace(element->tag, *value);
  }
  return found;
}

}  // namespace

bool has_dicom_magic(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::array<char, kPreamble> start{};
  return stream.read(start.data(), start.size()) &&
         std::string_view(start.data(), start.size()).ends_with("DICM");
}

DicomElements parse_dicom(std::string_view bytes) {
  Cursor cursor(bytes);
  if (!cursor.take(kPreamble)) return damaged({}, truncated());
  const Result<std::string> syntax = read_transfer_syntax(cursor);
  if (!syntax || syntax->empty()) return damaged({}, truncated());
  if (*syntax == "1.2.840.10008.1.2") return read_elements(cursor, Encoding::kImplicit);
  if (*syntax == "1.2.840.10008.1.2.2" || *syntax == "1.2.840.10008.1.2.1.99")
    return damaged({}, {ErrorCode::kFileUnsupported,
                        "it is big-endian or deflated, expected another transfer syntax"});
  return read_elements(cursor, Encoding::kExplicit);
}

}  // namespace lefort::io
