#include <lefort/io/gmsh.h>
#include <lefort/io/internal/gmsh_file.h>
#include <lefort/io/internal/wedge_order.h>
#include <lefort/io/read_text.h>
#include <lefort/mesh/match_faces_to_elements.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace lefort::io {
namespace {

using internal::GmshBlock;
using internal::GmshFile;
using internal::GmshKey;
using mesh::ElementShape;

// About ten million elements.
constexpr std::uintmax_t kMaxGmshBytes = std::uintmax_t(4) << 30;

// Index in the Gmsh element of each node (reference manual, "Node ordering").
constexpr std::array<std::uint8_t, 10> kTet10{0, 1, 2, 3, 4, 5, 6, 7, 9, 8};
constexpr std::array<std::uint8_t, 20> kHex20{0,  1, 2,  3,  4,  5,  6,  7,  8,  11,
                                              13, 9, 16, 18, 19, 17, 10, 12, 14, 15};
// Gmsh orders the triangles in reverse.
constexpr std::array<std::uint8_t, 15> kWedge15{0, 2, 1, 3, 5, 4, 7, 9, 6, 13, 14, 12, 8, 11, 10};
constexpr std::array<std::uint8_t, 20> kSame{0,  1,  2,  3,  4,  5,  6,  7,  8,  9,
                                             10, 11, 12, 13, 14, 15, 16, 17, 18, 19};

std::span<const std::uint8_t> gmsh_order(ElementShape shape) {
  switch (shape) {
    case ElementShape::kTet10:
      return kTet10;
    case ElementShape::kHex20:
      return kHex20;
    case ElementShape::kWedge15:
      return kWedge15;
    case ElementShape::kWedge6:
      return internal::kOtherWedgeOrder;
    default:
      return kSame;
  }
}

/// Maps node tags to indices.
class NodePlaces {
 public:
  static Result<NodePlaces> build(const std::vector<std::uint64_t>& tags) {
    if (tags.size() > std::size_t(std::numeric_limits<std::int32_t>::max()))
      return fail(ErrorCode::kFileUnsupported, "there are more nodes than 32-bit indices allow");
    NodePlaces places;
    for (const std::uint64_t tag : tags)
      places.sorted_.emplace_back(tag, std::int32_t(places.sorted_.size()));
    std::sort(places.sorted_.begin(), places.sorted_.end());
    for (std::size_t n = 1; n < places.sorted_.size(); ++n)
      if (places.sorted_[n].first == places.sorted_[n - 1].first)
        return fail(ErrorCode::kFileCorrupt,
                    fmt::format("node {} is defined twice", places.sorted_[n].first));
    return places;
  }

  [[nodiscard]] std::optional<std::int32_t> find(std::uint64_t tag) const {
    const auto at = std::lower_bound(sorted_.begin(), sorted_.end(), std::pair(tag, 0));
    if (at == sorted_.end() || at->first != tag) return std::nullopt;
    return at->second;
  }

 private:
  std::vector<std::pair<std::uint64_t, std::int32_t>> sorted_;
};

/// Element blocks of a file with node indices.
struct PlacedBlock {
  const GmshBlock* block;
  std::vector<std::int32_t> nodes;
};

Result<std::vector<PlacedBlock>> placed_blocks(const GmshFile& file) {
  LEFORT_TRY(const NodePlaces places, NodePlaces::build(file.node_tags));
  std::vector<PlacedBlock> placed;
  for (const GmshBlock& block : file.blocks) {
    PlacedBlock& next = placed.emplace_back(PlacedBlock{&block, {}});
    next.nodes.reserve(block.node_tags.size());
    for (std::size_t n = 0; n < block.node_tags.size(); ++n) {
      const auto node = places.find(block.node_tags[n]);
      if (!node)
        return fail(ErrorCode::kFileCorrupt,
                    fmt::format("element {} refers to node {}, which is missing",
                                block.element_tags[n / std::size_t(block.type->nodes)],
                                block.node_tags[n]));
      next.nodes.push_back(*node);
    }
  }
  return placed;
}

std::span<const int> groups_of(const GmshFile& file, const GmshKey& entity) {
  const auto found = file.groups_of.find(entity);
  if (found == file.groups_of.end()) return {};
  return found->second;
}

Result<std::int32_t> region_of(const GmshFile& file, const GmshKey& volume) {
  const auto groups = groups_of(file, volume);
  if (groups.size() > 1)
    return fail(ErrorCode::kMeshInvalid,
                fmt::format("volume {} is in the physical groups {}, expected at most one",
                            volume.second, fmt::join(groups, " and ")));
  return groups.empty() ? 0 : groups[0];
}

/// Returns the elements with the node numbering of the file.
Result<void> add_elements(const GmshFile& file, const std::vector<PlacedBlock>& blocks,
                          mesh::VolumeMesh& mesh) {
  for (const auto& [block, nodes] : blocks) {
    if (!block->type->element) continue;
    const ElementShape shape = *block->type->element;
    LEFORT_TRY(const std::int32_t region, region_of(file, block->entity));
    auto same = std::find_if(mesh.blocks.begin(), mesh.blocks.end(),
                             [&](const auto& other) { return other.shape == shape; });
    if (same == mesh.blocks.end())
      same = mesh.blocks.insert(same, {.shape = shape, .nodes = {}, .region = {}});
    const auto order = gmsh_order(shape);
    const auto count = std::size_t(mesh::node_count(shape));
    for (std::size_t first = 0; first < nodes.size(); first += count) {
      for (std::size_t a = 0; a < count; ++a) same->nodes.push_back(nodes[first + order[a]]);
      same->region.push_back(region);
    }
  }
  if (mesh.blocks.empty())
    return fail(ErrorCode::kMeshInvalid,
                "there are no volume elements; if a mesh has physical groups, Gmsh saves only "
                "these, so it needs a Physical Volume");
  return {};
}

/// Removes nodes without an element. \returns the new index of each node of the file, or -1.
std::vector<std::int32_t> number_nodes(const GmshFile& file, mesh::VolumeMesh& mesh) {
  std::vector<std::int32_t> number(file.nodes.size(), -1);
  for (const mesh::ElementBlock& block : mesh.blocks)
    for (const std::int32_t node : block.nodes) number[std::size_t(node)] = 0;
  for (std::size_t n = 0; n < number.size(); ++n) {
    if (number[n] < 0) continue;
    number[n] = std::int32_t(mesh.nodes_L.size());
    mesh.nodes_L.push_back(file.nodes[n]);
  }
  for (mesh::ElementBlock& block : mesh.blocks)
    for (std::int32_t& node : block.nodes) node = number[std::size_t(node)];
  return number;
}

std::string group_name(const GmshFile& file, const GmshKey& group) {
  constexpr std::array<const char*, 3> kKinds{"point", "curve", "surface"};
  const auto named = file.group_names.find(group);
  if (named != file.group_names.end()) return named->second;
  return fmt::format("{} {}", kKinds[std::size_t(group.first)], group.second);
}

/// Reads the nodes and faces of a physical group of dimension 0 to 2.
struct Group {
  std::vector<std::int32_t> nodes;
  std::vector<mesh::Face> faces;
};

Result<std::map<GmshKey, Group>> find_groups(const GmshFile& file,
                                             const std::vector<PlacedBlock>& blocks,
                                             const std::vector<std::int32_t>& number) {
  std::map<GmshKey, Group> found;
  for (const auto& [block, nodes] : blocks) {
    if (block->type->dimension == 3) continue;
    for (const int tag : groups_of(file, block->entity)) {
      const GmshKey key{block->type->dimension, tag};
      Group& group = found[key];
      const auto per_element = std::size_t(block->type->nodes);
      for (std::size_t n = 0; n < nodes.size(); ++n) {
        const std::int32_t node = number[std::size_t(nodes[n])];
        if (node < 0)
          return fail(ErrorCode::kMeshInvalid,
                      fmt::format("physical group \"{}\" contains node {}, which is in no volume",
                                  group_name(file, key), block->node_tags[n]));
        group.nodes.push_back(node);
        if (!block->type->face) continue;
        if (n % per_element == 0) group.faces.push_back({*block->type->face, {}});
        group.faces.back().nodes[n % per_element] = node;
      }
    }
  }
  return found;
}

Result<void> add_sets(const GmshFile& file, std::map<GmshKey, Group> groups,
                      mesh::VolumeMesh& mesh) {
  for (auto& [key, group] : groups) {
    const std::string name = group_name(file, key);
    std::sort(group.nodes.begin(), group.nodes.end());
    group.nodes.erase(std::unique(group.nodes.begin(), group.nodes.end()), group.nodes.end());
    if (!mesh.node_sets.emplace(name, std::move(group.nodes)).second)
      return fail(ErrorCode::kMeshInvalid,
                  fmt::format("two physical groups are named \"{}\", the names of points, curves "
                              "and surfaces must differ",
                              name));
    if (key.first != 2) continue;
    auto attached = mesh::match_faces_to_elements(mesh, group.faces);
    if (!attached)
      return fail(attached.error().code,
                  fmt::format("physical group \"{}\": {}", name, attached.error().message));
    mesh.face_sets.emplace(name, std::move(*attached));
  }
  return {};
}

/// Checks for names without members: some writers omit $Entities, which defines the groups.
Result<void> check_groups(const GmshFile& file) {
  const bool has_members = std::any_of(file.groups_of.begin(), file.groups_of.end(),
                                       [](const auto& entity) { return !entity.second.empty(); });
  if (file.group_names.empty() || has_members) return {};
  return fail(ErrorCode::kMeshInvalid,
              fmt::format("it names physical groups, as \"{}\", but its $Entities assigns nothing "
                          "to them; save it with Gmsh",
                          file.group_names.begin()->second));
}

Result<mesh::VolumeMesh> convert(const GmshFile& file) {
  mesh::VolumeMesh mesh;
  LEFORT_TRY_VOID(check_groups(file));
  LEFORT_TRY(const std::vector<PlacedBlock> blocks, placed_blocks(file));
  LEFORT_TRY_VOID(add_elements(file, blocks, mesh));
  const std::vector<std::int32_t> number = number_nodes(file, mesh);
  LEFORT_TRY(auto groups, find_groups(file, blocks, number));
  LEFORT_TRY_VOID(add_sets(file, std::move(groups), mesh));
  for (const auto& [key, name] : file.group_names)
    if (key.first == 3) mesh.region_names[key.second] = name;
  return mesh;
}

}  // namespace

Result<mesh::VolumeMesh> read_gmsh(const std::filesystem::path& file) {
  LEFORT_TRY(const std::string bytes, read_text(file, kMaxGmshBytes));
  const auto named = [&](const Error& error) {
    return fail(error.code, fmt::format("mesh {}: {}", file.string(), error.message));
  };
  const auto parsed = internal::parse_gmsh(bytes);
  if (!parsed) return named(parsed.error());
  auto mesh = convert(*parsed);
  if (!mesh) return named(mesh.error());
  return mesh;
}

}  // namespace lefort::io
