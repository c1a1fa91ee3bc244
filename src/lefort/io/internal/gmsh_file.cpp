#include <lefort/io/internal/gmsh_file.h>
#include <lefort/io/internal/surface_formats.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>

namespace lefort::io::internal {
namespace {

static_assert(std::endian::native == std::endian::little,
              "binary files are read without conversion");

using mesh::ElementShape;
using mesh::FaceShape;

/// Gmsh reference manual, "MSH file format", table of element types.
constexpr std::array kGmshTypes{
    GmshType{1, "2-node line", 1, 2, {}, {}},
    GmshType{2, "3-node triangle", 2, 3, {}, FaceShape::kTri3},
    GmshType{3, "4-node quadrangle", 2, 4, {}, FaceShape::kQuad4},
    GmshType{4, "4-node tetrahedron", 3, 4, ElementShape::kTet4, {}},
    GmshType{5, "8-node hexahedron", 3, 8, ElementShape::kHex8, {}},
    GmshType{6, "6-node prism", 3, 6, ElementShape::kWedge6, {}},
    GmshType{7, "5-node pyramid", 3, 5, ElementShape::kPyramid5, {}},
    GmshType{8, "3-node line", 1, 3, {}, {}},
    GmshType{9, "6-node triangle", 2, 6, {}, FaceShape::kTri6},
    GmshType{11, "10-node tetrahedron", 3, 10, ElementShape::kTet10, {}},
    GmshType{15, "point", 0, 1, {}, {}},
    GmshType{16, "8-node quadrangle", 2, 8, {}, FaceShape::kQuad8},
    GmshType{17, "20-node hexahedron", 3, 20, ElementShape::kHex20, {}},
    GmshType{18, "15-node prism", 3, 15, ElementShape::kWedge15, {}},
};

/// Types that the solver does not support, for the message. An element type of Gmsh that the solver
/// does not support, and the Gmsh option to set instead.
struct UnsupportedType {
  int number;
  std::string_view name;
  std::string_view remedy;
};

constexpr std::string_view kNoMiddles =
    "quadratic elements must have nodes on edges only, Mesh.SecondOrderIncomplete = 1";
constexpr std::string_view kNoQuadraticPyramids =
    "a mesh with pyramids must be linear, Mesh.ElementOrder = 1";
constexpr std::string_view kNoCubic =
    "the order must be 2 at most, Mesh.ElementOrder = 2 and Mesh.SecondOrderIncomplete = 1";
constexpr std::string_view kSolvedShapes =
    "a mesh must be of tetrahedra, pyramids, prisms and hexahedra";

constexpr std::array<UnsupportedType, 12> kUnsupportedTypes{
    {{10, "9-node quadrangle", kNoMiddles},
     {12, "27-node hexahedron", kNoMiddles},
     {13, "18-node prism", kNoMiddles},
     {14, "14-node pyramid", kNoQuadraticPyramids},
     {19, "13-node pyramid", kNoQuadraticPyramids},
     {20, "9-node triangle", kNoCubic},
     {21, "10-node triangle", kNoCubic},
     {26, "4-node line", kNoCubic},
     {29, "20-node tetrahedron", kNoCubic},
     {36, "16-node quadrangle", kNoCubic},
     {90, "40-node prism", kNoCubic},
     {92, "64-node hexahedron", kNoCubic}}};

Error corrupt(std::string why) { return {ErrorCode::kFileCorrupt, std::move(why)}; }

/// Reads numbers and words from the front. After the first failure all are 0 and error() is set.
class Source {
 public:
  explicit Source(std::string_view bytes) : rest_(bytes) {}

  [[nodiscard]] bool has_failed() const { return error_.has_value(); }
  [[nodiscard]] const Error& error() const { return *error_; }
  void fail(Error error) {
    if (!error_) error_ = std::move(error);
    rest_ = {};
  }
  void set_binary() { is_binary_ = true; }

  /// Reads a word of text, also in a binary file; empty at the end.
  std::string_view word() { return take_word(rest_); }
  /// Reads the rest of a line of text.
  std::string_view line() { return take_line(rest_); }
  /// Skips past `mark`.
  void skip_past(std::string_view mark) {
    const std::size_t at = rest_.find(mark);
    if (at == std::string_view::npos)
      fail(corrupt(fmt::format("the file is truncated, {} is missing", printable(mark))));
    else
      rest_.remove_prefix(at + mark.size());
  }

  int whole() { return is_binary_ ? raw<int>() : text<int>(); }
  std::uint64_t size() { return is_binary_ ? raw<std::uint64_t>() : text<std::uint64_t>(); }
  double number() {
    if (is_binary_) return raw<double>();
    double value = 0.0;
    const std::string_view next = word();
    if (!parse_number(next, value)) fail_at(next);
    return value;
  }

  /// Reads the number of items of so many numbers each: not more than fit into the file.
  std::size_t count(std::size_t numbers_per_item, std::string_view what) {
    const std::uint64_t stated = size();
    const std::size_t min_bytes = numbers_per_item * (is_binary_ ? 4 : 2);
    if (stated <= rest_.size() / min_bytes + 1) return std::size_t(stated);
    fail(corrupt(fmt::format("the file states {} {}, more than fit into it", stated, what)));
    return 0;
  }

  /// Reads an integer of four bytes, also in a binary file, as after its first line.
  int raw_int() { return raw<int>(); }

 private:
  template <class T>
  T raw() {
    T value{};
    if (rest_.size() < sizeof(T)) {
      fail(corrupt("the file is truncated"));
      return value;
    }
    std::memcpy(&value, rest_.data(), sizeof(T));
    rest_.remove_prefix(sizeof(T));
    return value;
  }

  template <class T>
  T text() {
    T value{};
    const std::string_view next = word();
    const auto [end, problem] = std::from_chars(next.data(), next.data() + next.size(), value);
    if (problem == std::errc{} && end == next.data() + next.size()) return value;
    fail_at(next);
    return T{};
  }

  void fail_at(std::string_view found) {
    if (found.empty())
      fail(corrupt("the file is truncated"));
    else
      fail(corrupt(fmt::format("\"{}\" is not a number", printable(found))));
  }

  static std::string printable(std::string_view text) {
    std::string safe(text.substr(0, 20));
    std::replace_if(
        safe.begin(), safe.end(), [](char c) { return c < 0x20 || c > 0x7e; }, '?');
    return safe;
  }

  std::string_view rest_;
  std::optional<Error> error_;
  bool is_binary_ = false;
};

void read_format(Source& source) {
  double version = 0.0;
  const std::string_view number = source.word();
  if (!parse_number(number, version)) return source.fail(corrupt("it has no version"));
  if (version != 4.1)
    return source.fail(
        {ErrorCode::kFileUnsupported,
         fmt::format("Gmsh format {} is not supported, only 4.1: convert it with gmsh OLD.msh "
                     "-save -format msh41 -o NEW.msh, or set Mesh.MshFileVersion = 4.1",
                     version)});
  const std::string_view is_binary = source.word();
  const std::string_view size = source.word();
  if (is_binary == "1" && size != "8")
    return source.fail({ErrorCode::kFileUnsupported,
                        "its numbers do not have 8 bytes, other binary files are not supported"});
  if (is_binary != "0" && is_binary != "1")
    return source.fail(corrupt("its file type is neither text (0) nor binary (1)"));
  source.line();
  if (is_binary == "0") return;
  source.set_binary();
  const int one = source.raw_int();
  if (!source.has_failed() && one != 1)
    source.fail({ErrorCode::kFileUnsupported, "it is big-endian, only little-endian is supported"});
}

/// Text, also in binary files.
void read_names(Source& source, GmshFile& file) {
  const auto number = [&] {
    int value = 0;
    const std::string_view word = source.word();
    const auto [end, problem] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (problem != std::errc{} || end != word.data() + word.size())
      source.fail(corrupt("the list of physical names is damaged"));
    return value;
  };
  const int count = number();
  for (int n = 0; n < count && !source.has_failed(); ++n) {
    const int dimension = number();
    const int tag = number();
    const std::string_view line = source.line();
    const std::size_t begin = line.find('"');
    const std::size_t end = line.rfind('"');
    if (begin == std::string_view::npos || end == begin || dimension < 0 || dimension > 3)
      return source.fail(corrupt("the list of physical names is damaged"));
    const std::string_view name = line.substr(begin + 1, end - begin - 1);
    if (std::any_of(name.begin(), name.end(), [](char c) { return std::uint8_t(c) < 0x20; }))
      return source.fail(
          corrupt(fmt::format("the name of physical group {} is not printable", tag)));
    if (!name.empty()) file.group_names[{dimension, tag}] = name;
  }
}

void read_entities(Source& source, GmshFile& file) {
  std::array<std::size_t, 4> counts{};
  for (std::size_t& count : counts) count = source.count(5, "entities");
  for (int dimension = 0; dimension < 4; ++dimension)
    for (std::size_t n = 0; n < counts[std::size_t(dimension)] && !source.has_failed(); ++n) {
      const int tag = source.whole();
      for (int c = 0; c < (dimension == 0 ? 3 : 6); ++c) source.number();
      std::vector<int>& groups = file.groups_of[{dimension, tag}];
      const std::size_t group_count = source.count(1, "physical groups");
      for (std::size_t g = 0; g < group_count && !source.has_failed(); ++g) {
        const int group = source.whole();  // Negative for a reversed entity.
        groups.push_back(group == std::numeric_limits<int>::min() ? 0 : std::abs(group));
      }
      if (dimension == 0) continue;
      const std::size_t bounds = source.count(1, "bounding entities");
      for (std::size_t b = 0; b < bounds && !source.has_failed(); ++b) source.whole();
    }
}

void read_nodes(Source& source, GmshFile& file) {
  const std::size_t blocks = source.count(4, "blocks of nodes");
  const std::size_t total = source.count(4, "nodes");
  source.size();  // Min and max tag.
  source.size();
  for (std::size_t b = 0; b < blocks && !source.has_failed(); ++b) {
    const int dimension = source.whole();
    source.whole();
    const int is_parametric = source.whole();
    const std::size_t count = source.count(4, "nodes in a block");
    const int parameters = is_parametric != 0 ? std::clamp(dimension, 0, 3) : 0;
    for (std::size_t n = 0; n < count && !source.has_failed(); ++n)
      file.node_tags.push_back(source.size());
    for (std::size_t n = 0; n < count && !source.has_failed(); ++n) {
      const double x = source.number(), y = source.number(), z = source.number();
      for (int p = 0; p < parameters; ++p) source.number();
      file.nodes.emplace_back(x, y, z);
      if (!file.nodes.back().allFinite())
        source.fail(corrupt(fmt::format("node {} has a coordinate that is not finite",
                                        file.node_tags[file.nodes.size() - 1])));
    }
  }
  if (!source.has_failed() && file.nodes.size() != total)
    source.fail(
        corrupt(fmt::format("there are {} nodes, the file states {}", file.nodes.size(), total)));
}

const GmshType* find_type(Source& source, int number) {
  const auto* const known =
      std::find_if(kGmshTypes.begin(), kGmshTypes.end(),
                   [&](const GmshType& type) { return type.number == number; });
  if (known != kGmshTypes.end()) return known;
  const auto* const unsupported =
      std::find_if(kUnsupportedTypes.begin(), kUnsupportedTypes.end(),
                   [&](const UnsupportedType& type) { return type.number == number; });
  const UnsupportedType type = unsupported == kUnsupportedTypes.end()
                                   ? UnsupportedType{number, "unknown", kSolvedShapes}
                                   : *unsupported;
  source.fail({ErrorCode::kFileUnsupported,
               fmt::format("elements of Gmsh type {} ({}) are not supported; {}", number, type.name,
                           type.remedy)});
  return nullptr;
}

void read_elements(Source& source, GmshFile& file) {
  const std::size_t blocks = source.count(4, "blocks of elements");
  const std::size_t total = source.count(2, "elements");
  source.size();
  source.size();
  std::size_t read = 0;
  for (std::size_t b = 0; b < blocks && !source.has_failed(); ++b) {
    GmshBlock block;
    const int dimension = source.whole();
    block.entity = {dimension, source.whole()};
    const int number = source.whole();
    const std::size_t count = source.count(2, "elements in a block");
    if (source.has_failed()) return;
    block.type = find_type(source, number);
    if (block.type == nullptr) return;
    if (block.type->dimension != dimension)
      return source.fail(corrupt(fmt::format("a block of {}s is stated to have {} dimensions",
                                             block.type->name, dimension)));
    for (std::size_t e = 0; e < count && !source.has_failed(); ++e) {
      block.element_tags.push_back(source.size());
      for (int n = 0; n < block.type->nodes; ++n) block.node_tags.push_back(source.size());
    }
    read += count;
    file.blocks.push_back(std::move(block));
  }
  if (!source.has_failed() && read != total)
    source.fail(corrupt(fmt::format("there are {} elements, the file states {}", read, total)));
}

}  // namespace

Result<GmshFile> parse_gmsh(std::string_view bytes) {
  Source source(bytes);
  GmshFile file;
  if (source.word() != "$MeshFormat")
    return tl::unexpected(corrupt("not a Gmsh file: it does not begin with $MeshFormat"));
  read_format(source);
  source.skip_past("$EndMeshFormat");
  bool has_nodes = false, has_elements = false;
  for (std::string section(source.word()); !section.empty() && !source.has_failed();
       section = source.word()) {
    if (!section.starts_with('$'))
      source.fail(corrupt("a section does not begin with its name, the file is damaged"));
    else if (section == "$PartitionedEntities")
      source.fail({ErrorCode::kFileUnsupported,
                   "the mesh is partitioned: unpartition it in Gmsh and save it again"});
    else if (section == "$Nodes" && std::exchange(has_nodes, true))
      source.fail(corrupt("there are two lists of nodes"));
    else if (section == "$Elements" && std::exchange(has_elements, true))
      source.fail(corrupt("there are two lists of elements"));
    const bool is_list = section == "$Entities" || section == "$Nodes" || section == "$Elements";
    if (is_list) source.line();  // Binary numbers begin after the line break.
    if (section == "$PhysicalNames") read_names(source, file);
    if (section == "$Entities") read_entities(source, file);
    if (section == "$Nodes") read_nodes(source, file);
    if (section == "$Elements") read_elements(source, file);
    const std::string end = "$End" + section.substr(1);
    if (!is_list)
      source.skip_past(end);
    else if (!source.has_failed() && source.word() != end)
      source.fail(corrupt(fmt::format("{} does not end with {}", section, end)));
  }
  if (source.has_failed()) return tl::unexpected(source.error());
  if (!has_nodes || !has_elements)
    return tl::unexpected(corrupt("nodes or elements are missing, expected both"));
  return file;
}

}  // namespace lefort::io::internal
