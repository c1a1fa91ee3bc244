/// \file
/// The elements, or the faces, around each node.
#pragma once

#include <lefort/core/types.h>

#include <cstdint>
#include <span>
#include <vector>

namespace lefort::mesh::internal {

/// A list per node, stored one after another.
struct Lists {
  std::vector<std::size_t> first;
  std::vector<Index> items;
  [[nodiscard]] std::span<const Index> of(std::size_t node) const {
    return std::span(items).subspan(first[node], first[node + 1] - first[node]);
  }
};

/// \param node_count  number of nodes.
/// \param user_count  number of elements or faces.
/// \param nodes_of    nodes_of(user): the nodes of an element or face.
/// \returns for each node the users whose nodes contain it, ascending.
template <class Nodes>
[[nodiscard]] Lists users_of_nodes(Index node_count, Index user_count, const Nodes& nodes_of) {
  Lists lists;
  lists.first.assign(std::size_t(node_count) + 1, 0);
  for (Index user = 0; user < user_count; ++user)
    for (const std::int32_t node : nodes_of(user)) ++lists.first[std::size_t(node) + 1];
  for (std::size_t n = 1; n < lists.first.size(); ++n) lists.first[n] += lists.first[n - 1];
  lists.items.resize(lists.first.back());
  std::vector<std::size_t> next = lists.first;
  for (Index user = 0; user < user_count; ++user)
    for (const std::int32_t node : nodes_of(user)) lists.items[next[std::size_t(node)]++] = user;
  return lists;
}

}  // namespace lefort::mesh::internal
