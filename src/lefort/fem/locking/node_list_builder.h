/// \file
/// Builds the node lists of patches of elements, one after the other, in one common list.
#pragma once

#include <lefort/core/types.h>
#include <lefort/fem/assembly/force_term.h>

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace lefort::fem {

/// Range of one patch in the common list.
struct PatchRange {
  std::int32_t first = 0;
  std::int32_t count = 0;
};

/// Nodes are added to the last patch only.
class NodeListBuilder {
 public:
  /// Starts a new patch.
  void open() { last_ = {.first = std::int32_t(nodes_.size()), .count = 0}; }

  [[nodiscard]] PatchRange last() const { return last_; }

  /// \param nodes  of an element, all different.
  /// \returns whether the last patch would have at most kMaxLocalNodes after these nodes are added.
  [[nodiscard]] bool has_room_for(std::span<const std::int32_t> nodes) const {
    const auto more = std::ranges::count_if(
        nodes, [&](std::int32_t node) { return local_number(node) == last_.count; });
    return last_.count + more <= kMaxLocalNodes;
  }

  /// Adds a node to the last patch unless the patch has it already.
  /// \returns its local number in the last patch.
  std::int32_t add(std::int32_t node) {
    const std::int32_t local = local_number(node);
    if (local == last_.count) {
      nodes_.push_back(node);
      ++last_.count;
    }
    return local;
  }

  [[nodiscard]] std::vector<std::int32_t> take() { return std::move(nodes_); }

 private:
  /// \returns the local number of a node in the last patch, or the node count of the patch if it
  ///   does not have the node.
  [[nodiscard]] std::int32_t local_number(std::int32_t node) const {
    const auto begin = nodes_.begin() + last_.first;
    return std::int32_t(std::find(begin, nodes_.end(), node) - begin);
  }

  std::vector<std::int32_t> nodes_;
  PatchRange last_;
};

}  // namespace lefort::fem
