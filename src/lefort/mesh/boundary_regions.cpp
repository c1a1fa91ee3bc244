#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/mesh/boundary_faces.h>
#include <lefort/mesh/boundary_regions.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace lefort::mesh {
namespace {

/// \returns the first rule that applies to the point; rules.size() if none does.
std::size_t rule_of(const Vec3& p_L, std::span<const BoundaryRule> rules) {
  for (std::size_t r = 0; r < rules.size(); ++r)
    if (rules[r].distance_mm(p_L) <= rules[r].tolerance_mm) return r;
  return rules.size();
}

/// \returns the most frequent rule of the nodes; in a tie the first one.
std::size_t majority(std::span<const std::int32_t> nodes,
                     const std::vector<std::size_t>& rule_of_node) {
  const auto votes_for = [&](std::size_t rule) {
    return std::count_if(nodes.begin(), nodes.end(), [&](std::int32_t node) {
      return rule_of_node[std::size_t(node)] == rule;
    });
  };
  std::size_t best = rule_of_node[std::size_t(nodes[0])];
  for (const std::int32_t node : nodes) {
    const std::size_t rule = rule_of_node[std::size_t(node)];
    if (std::pair(-votes_for(rule), rule) < std::pair(-votes_for(best), best)) best = rule;
  }
  return best;
}

}  // namespace

VolumeMesh name_boundary(VolumeMesh mesh, std::span<const BoundaryRule> rules,
                         const std::string& rest) {
  const std::vector<Face> faces = boundary_faces(mesh);
  const std::vector<std::int32_t> nodes = nodes_of_faces(faces);

  std::vector<std::string> names;
  for (const BoundaryRule& rule : rules) names.push_back(rule.name);
  names.push_back(rest);
  for (const std::string& name : names) {
    LEFORT_CHECK(name != "boundary" && std::count(names.begin(), names.end(), name) == 1);
    mesh.node_sets[name].clear();
    mesh.face_sets[name].clear();
  }

  std::vector<std::size_t> rule_of_node(std::size_t(mesh.node_count()));
  parallel_for(Index(nodes.size()), [&](Index n) {
    const auto node = std::size_t(nodes[std::size_t(n)]);
    rule_of_node[node] = rule_of(mesh.nodes_L[node], rules);
  });

  for (const std::int32_t node : nodes)
    mesh.node_sets[names[rule_of_node[std::size_t(node)]]].push_back(node);
  for (const Face& face : faces)
    mesh.face_sets[names[majority(nodes_of(face), rule_of_node)]].push_back(face);
  mesh.node_sets["boundary"] = nodes;
  mesh.face_sets["boundary"] = faces;
  return mesh;
}

}  // namespace lefort::mesh
