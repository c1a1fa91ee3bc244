#include <lefort/io/internal/surface_formats.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>

namespace lefort::io::internal {
namespace {

enum class Number { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };

struct NumberType {
  std::string_view name;
  Number number;
  std::size_t bytes;
};

constexpr std::array<NumberType, 16> kPlyTypes{{
    {"char", Number::kInt8, 1},
    {"int8", Number::kInt8, 1},
    {"uchar", Number::kUint8, 1},
    {"uint8", Number::kUint8, 1},
    {"short", Number::kInt16, 2},
    {"int16", Number::kInt16, 2},
    {"ushort", Number::kUint16, 2},
    {"uint16", Number::kUint16, 2},
    {"int", Number::kInt32, 4},
    {"int32", Number::kInt32, 4},
    {"uint", Number::kUint32, 4},
    {"uint32", Number::kUint32, 4},
    {"float", Number::kFloat, 4},
    {"float32", Number::kFloat, 4},
    {"double", Number::kDouble, 8},
    {"float64", Number::kDouble, 8},
}};

const NumberType* find_type(std::string_view name) {
  const auto type = std::find_if(kPlyTypes.begin(), kPlyTypes.end(),
                                 [&](const NumberType& t) { return t.name == name; });
  return type == kPlyTypes.end() ? nullptr : &*type;
}

struct Property {
  std::string name;
  const NumberType* type = nullptr;
  const NumberType* count_type = nullptr;  ///< For a list; null for a single number.
};

struct PlyElement {
  std::string name;
  Index count = 0;
  std::vector<Property> properties;
};

struct PlyHeader {
  std::string format;
  std::vector<PlyElement> elements;
  bool is_ras = false;
};

/// Removes the header from the front of `bytes`; nothing if it is invalid.
std::optional<PlyHeader> take_header(std::string_view& bytes) {
  if (take_line(bytes) != "ply") return {};
  PlyHeader header;
  while (!bytes.empty()) {
    std::string_view line = take_line(bytes);
    const bool says_ras = line.find("SPACE=RAS") != std::string_view::npos;
    const std::string_view word = take_word(line);
    if (word == "end_header") return header;
    if (word == "format") {
      header.format = take_word(line);
    } else if (word == "comment") {
      header.is_ras |= says_ras;
    } else if (word == "element") {
      PlyElement element{std::string(take_word(line)), 0, {}};
      double count = 0.0;
      if (!parse_number(take_word(line), count) || !(count >= 0.0 && count < 2e9)) return {};
      element.count = Index(count);
      header.elements.push_back(std::move(element));
    } else if (word == "property") {
      if (header.elements.empty()) return {};
      Property property;
      std::string_view type = take_word(line);
      if (type == "list") {
        property.count_type = find_type(take_word(line));
        if (property.count_type == nullptr) return {};
        type = take_word(line);
      }
      property.type = find_type(type);
      property.name = take_word(line);
      if (property.type == nullptr) return {};
      header.elements.back().properties.push_back(std::move(property));
    }
  }
  return {};
}

/// Reads numbers from the front of the data, as text or in either byte order.
class PlyNumbers {
 public:
  PlyNumbers(std::string_view data, const std::string& format) : data_(data) {
    is_text_ = format == "ascii";
    swap_ = (format == "binary_big_endian") == (std::endian::native == std::endian::little);
  }
  [[nodiscard]] std::size_t left() const { return data_.size(); }

  /// False at the end of the data, or if the next word is not a number.
  bool take(const NumberType& type, double& number) {
    if (is_text_) return parse_number(take_word(data_), number);
    if (data_.size() < type.bytes) return false;
    std::array<char, 8> bytes{};
    std::copy_n(data_.begin(), type.bytes, bytes.begin());
    data_.remove_prefix(type.bytes);
    if (swap_) std::reverse(bytes.begin(), bytes.begin() + std::ptrdiff_t(type.bytes));
    switch (type.number) {
      case Number::kInt8:
        number = as<std::int8_t>(bytes);
        break;
      case Number::kUint8:
        number = as<std::uint8_t>(bytes);
        break;
      case Number::kInt16:
        number = as<std::int16_t>(bytes);
        break;
      case Number::kUint16:
        number = as<std::uint16_t>(bytes);
        break;
      case Number::kInt32:
        number = as<std::int32_t>(bytes);
        break;
      case Number::kUint32:
        number = as<std::uint32_t>(bytes);
        break;
      case Number::kFloat:
        number = double(as<float>(bytes));
        break;
      case Number::kDouble:
        number = as<double>(bytes);
        break;
    }
    return true;
  }

 private:
  template <class T>
  static T as(const std::array<char, 8>& bytes) {
    T value;
    std::memcpy(&value, bytes.data(), sizeof value);
    return value;
  }
  std::string_view data_;
  bool is_text_ = false;
  bool swap_ = false;
};

std::int32_t vertex_index(double number) {
  const bool fits = number >= 0.0 && number <= double(std::numeric_limits<std::int32_t>::max());
  return fits && number == std::floor(number) ? std::int32_t(number) : -1;
}

/// Adds all elements of one kind to the surface; false if the data ends early.
bool take_element(const PlyElement& element, PlyNumbers& numbers, SurfaceFile& surface) {
  if (element.properties.empty()) return element.count == 0;
  constexpr std::string_view kAxes = "xyz";
  std::vector<double> list;
  std::vector<std::int32_t> corners;
  for (Index n = 0; n < element.count; ++n) {
    Vec3 p = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
    for (const Property& property : element.properties) {
      double count = 1.0;
      if (property.count_type != nullptr && !numbers.take(*property.count_type, count))
        return false;
      // Every number needs at least one byte, which limits the count.
      if (!(count >= 0.0 && count <= double(numbers.left()))) return false;
      list.resize(std::size_t(count));
      for (double& number : list)
        if (!numbers.take(*property.type, number)) return false;

      const std::size_t axis = property.name.size() == 1 ? kAxes.find(property.name) : kAxes.npos;
      if (element.name == "vertex" && property.count_type == nullptr && axis != kAxes.npos)
        p[Index(axis)] = list[0];
      if (element.name == "face" && property.name.starts_with("vertex_ind")) {
        corners.resize(list.size());
        std::transform(list.begin(), list.end(), corners.begin(), vertex_index);
        add_polygon(corners, surface);
      }
    }
    if (element.name == "vertex") surface.vertices.push_back(p);
  }
  return true;
}

}  // namespace

Result<SurfaceFile> parse_ply(std::string_view bytes, const std::string& name) {
  const std::optional<PlyHeader> header = take_header(bytes);
  if (!header || (header->format != "ascii" && header->format != "binary_little_endian" &&
                  header->format != "binary_big_endian"))
    return fail(ErrorCode::kFileCorrupt,
                fmt::format("{} is not a PLY file: its header is damaged", name));
  SurfaceFile surface;
  surface.is_ras = header->is_ras;
  PlyNumbers numbers(bytes, header->format);
  for (const PlyElement& element : header->elements)
    if (!take_element(element, numbers, surface))
      return fail(ErrorCode::kFileCorrupt,
                  fmt::format("{} is truncated or damaged: expected {} of element {}", name,
                              element.count, element.name));
  return surface;
}

std::string ply_bytes(const geometry::TriangleMesh& mesh) {
  std::string bytes = fmt::format(
      "ply\nformat {} 1.0\ncomment lefort; unit mm\ncomment SPACE=LPS\n"
      "element vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
      "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
      std::endian::native == std::endian::little ? "binary_little_endian" : "binary_big_endian",
      mesh.vertex_count(), mesh.triangle_count());
  const auto append = [&](const auto& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  for (const Vec3& p : mesh.vertices)
    for (Index axis = 0; axis < 3; ++axis) append(float(p[axis]));
  for (const geometry::Triangle& triangle : mesh.triangles) {
    append(std::uint8_t(3));
    for (const std::int32_t corner : triangle) append(corner);
  }
  return bytes;
}

}  // namespace lefort::io::internal
