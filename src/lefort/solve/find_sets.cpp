#include <lefort/mesh/boundary_faces.h>
#include <lefort/solve/find_sets.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <utility>

namespace lefort::solve {
namespace {

using NodeList = std::vector<std::int32_t>;

template <class Sets>
void add_names(const Sets& sets, std::set<std::string>& names) {
  for (const auto& [name, members] : sets) names.insert(name);
}

/// "a, b, c"; of a long list, the first names and the number of the others.
std::string listed(const std::set<std::string>& names) {
  constexpr std::size_t kMaxListed = 40;
  if (names.empty()) return "none";
  if (names.size() <= kMaxListed) return fmt::format("{}", fmt::join(names, ", "));
  const std::vector<std::string> first(names.begin(), std::next(names.begin(), kMaxListed));
  return fmt::format("{} and {} more", fmt::join(first, ", "), names.size() - kMaxListed);
}

Error no_such_set(const mesh::VolumeMesh& mesh, const std::string& set) {
  std::set<std::string> names;
  add_names(mesh.node_sets, names);
  add_names(mesh.face_sets, names);
  return {ErrorCode::kPlanInvalid,
          fmt::format("there is no set {}; the sets are: {}", set, listed(names))};
}

/// Those of `candidates` that belong to an element.
NodeList used_of(const NodeList& candidates, const std::vector<char>& used) {
  NodeList kept;
  std::copy_if(candidates.begin(), candidates.end(), std::back_inserter(kept),
               [&](std::int32_t node) { return used[std::size_t(node)] != 0; });
  return kept;
}

template <class Predicate>
NodeList used_where(const mesh::VolumeMesh& mesh, const std::vector<char>& used,
                    const Predicate& is_in) {
  NodeList nodes;
  for (std::size_t n = 0; n < mesh.nodes_L.size(); ++n)
    if (used[n] != 0 && is_in(mesh.nodes_L[n])) nodes.push_back(std::int32_t(n));
  return nodes;
}

/// Finds the nodes of each kind of choice.
struct NodeFinder {
  const mesh::VolumeMesh& mesh;
  const std::vector<char>& used;

  Result<NodeList> operator()(const NodesInBox& choice) const {
    return used_where(mesh, used, [&](const Vec3& p_L) { return choice.box_L.contains(p_L); });
  }
  Result<NodeList> operator()(const NodesOnPlane& choice) const {
    return used_where(mesh, used, [&](const Vec3& p_L) {
      return std::abs(choice.normal_L.dot(p_L - choice.point_L)) <= choice.within_mm;
    });
  }
  Result<NodeList> operator()(const NodesByNumber& choice) const {
    for (const std::int32_t node : choice.nodes)
      if (node < 0 || Index(node) >= mesh.node_count() || used[std::size_t(node)] == 0)
        return fail(ErrorCode::kPlanInvalid,
                    fmt::format("no element has node {}; the nodes are 0 to {}", node,
                                mesh.node_count() - 1));
    NodeList nodes = choice.nodes;
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    return nodes;
  }
  Result<NodeList> operator()(const NodeNearest& choice) const {
    std::optional<std::int32_t> nearest;
    double minimum = std::numeric_limits<double>::infinity();
    for (std::size_t n = 0; n < mesh.nodes_L.size(); ++n) {
      const double squared_distance = (mesh.nodes_L[n] - choice.point_L).squaredNorm();
      if (used[n] == 0 || !(squared_distance < minimum)) continue;
      nearest = std::int32_t(n);
      minimum = squared_distance;
    }
    return nearest ? NodeList{*nearest} : NodeList{};
  }
  Result<NodeList> operator()(const NodesOfRegion& choice) const {
    LEFORT_TRY(const std::int32_t region, find_region(mesh, choice.region));
    std::vector<char> of_region(mesh.nodes_L.size(), 0);
    for (const mesh::ElementBlock& block : mesh.blocks)
      for (Index e = 0; e < block.element_count(); ++e)
        if (block.region[std::size_t(e)] == region)
          for (int a = 0; a < mesh::node_count(block.shape); ++a)
            of_region[std::size_t(block.element(e)[a])] = 1;
    NodeList nodes;
    for (std::size_t n = 0; n < of_region.size(); ++n)
      if (of_region[n] != 0) nodes.push_back(std::int32_t(n));
    return nodes;
  }
};

}  // namespace

std::vector<char> nodes_of_elements(const mesh::VolumeMesh& mesh) {
  std::vector<char> used(mesh.nodes_L.size(), 0);
  for (const mesh::ElementBlock& block : mesh.blocks)
    for (const std::int32_t node : block.nodes) used[std::size_t(node)] = 1;
  return used;
}

Result<mesh::VolumeMesh> add_sets(mesh::VolumeMesh mesh, std::span<const SetChoice> sets) {
  const std::vector<char> used = nodes_of_elements(mesh);
  for (const SetChoice& set : sets) {
    const auto refuse = [&](const std::string& why) {
      return fail(ErrorCode::kPlanInvalid, fmt::format("sets.{}: {}", set.name, why));
    };
    if (mesh.node_sets.count(set.name) + mesh.face_sets.count(set.name) > 0)
      return refuse("the mesh has a set of that name");
    Result<NodeList> nodes = std::visit(NodeFinder{mesh, used}, set.nodes);
    if (!nodes) return refuse(nodes.error().message);
    if (nodes->empty()) return refuse("no node of an element lies there");
    mesh.node_sets[set.name] = *std::move(nodes);
  }
  return mesh;
}

Result<NodeList> find_nodes(const mesh::VolumeMesh& mesh, const std::string& set) {
  NodeList candidates;
  if (const auto nodes = mesh.node_sets.find(set); nodes != mesh.node_sets.end()) {
    candidates = nodes->second;
  } else if (const auto faces = mesh.face_sets.find(set); faces != mesh.face_sets.end()) {
    candidates = mesh::nodes_of_faces(faces->second);
  } else {
    return tl::unexpected(no_such_set(mesh, set));
  }
  NodeList nodes = used_of(candidates, nodes_of_elements(mesh));
  if (nodes.empty())
    return fail(ErrorCode::kPlanInvalid, fmt::format("set {} has no node of an element", set));
  return nodes;
}

Result<std::vector<mesh::Face>> find_faces(const mesh::VolumeMesh& mesh, const std::string& set) {
  const auto faces = mesh.face_sets.find(set);
  if (faces != mesh.face_sets.end() && !faces->second.empty()) return faces->second;
  if (mesh.node_sets.count(set) == 0 && faces == mesh.face_sets.end())
    return tl::unexpected(no_such_set(mesh, set));
  LEFORT_TRY(const NodeList nodes, find_nodes(mesh, set));
  std::vector<char> in_set(mesh.nodes_L.size(), 0);
  for (const std::int32_t node : nodes) in_set[std::size_t(node)] = 1;
  std::vector<mesh::Face> chosen;
  for (const mesh::Face& face : mesh::boundary_faces(mesh)) {
    const std::span<const std::int32_t> of_face = mesh::nodes_of(face);
    if (std::all_of(of_face.begin(), of_face.end(),
                    [&](std::int32_t node) { return in_set[std::size_t(node)] != 0; }))
      chosen.push_back(face);
  }
  if (chosen.empty())
    return fail(ErrorCode::kPlanInvalid,
                fmt::format("set {} has no face: no boundary face has all its nodes in it", set));
  return chosen;
}

std::vector<std::int32_t> regions_of(const mesh::VolumeMesh& mesh) {
  std::set<std::int32_t> regions;
  for (const mesh::ElementBlock& block : mesh.blocks)
    regions.insert(block.region.begin(), block.region.end());
  return {regions.begin(), regions.end()};
}

Result<std::int32_t> find_region(const mesh::VolumeMesh& mesh, const std::string& region) {
  const std::vector<std::int32_t> regions = regions_of(mesh);
  std::int32_t number = 0;
  const char* const end = region.data() + region.size();
  const auto [read_to, problem] = std::from_chars(region.data(), end, number);
  if (problem == std::errc() && read_to == end &&
      std::binary_search(regions.begin(), regions.end(), number))
    return number;
  std::set<std::string> names;
  for (const std::int32_t known : regions) {
    const auto name = mesh.region_names.find(known);
    if (name != mesh.region_names.end() && name->second == region) return known;
    names.insert(name == mesh.region_names.end() ? fmt::format("{}", known)
                                                 : fmt::format("{} ({})", known, name->second));
  }
  return fail(ErrorCode::kPlanInvalid,
              fmt::format("there is no region {}; the regions are: {}", region, listed(names)));
}

}  // namespace lefort::solve
