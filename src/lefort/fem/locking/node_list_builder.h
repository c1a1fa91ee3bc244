/// \file
/// Node lists of patches of elements, one after another, the last still growing.
#pragma once

#include <lefort/core/types.h>
#include <lefort/fem/assembly/force_term.h>

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace lefort::fem {

/// Which part of the common list is a patch's own.
struct PatchRange {
  std::int32_t first = 0;
  std::int32_t count = 0;
};

class NodeListBuilder {
 public:
  /// Begins a new patch.
  void open() { last_ = {.first = std::int32_t(nodes_.size()), .count = 0}; }

  [[nodiscard]] PatchRange last() const { return last_; }

  /// Whether the last patch can take an element with these nodes, all different.
  [[nodiscard]] bool has_room_for(std::span<const std::int32_t> nodes) const {
    const auto more = std::ranges::count_if(
        nodes, [&](std::int32_t node) { return place_of(node) == last_.count; });
    return last_.count + more <= kMaxLocalNodes;
  }

  /// \returns the place of `node` in the last patch, where it is put if it is not there yet.
  std::int32_t add(std::int32_t node) {
    const std::int32_t place = place_of(node);
    if (place == last_.count) {
      nodes_.push_back(node);
      ++last_.count;
    }
    return place;
  }

  [[nodiscard]] std::vector<std::int32_t> take() { return std::move(nodes_); }

 private:
  /// Or the number of its nodes.
  [[nodiscard]] std::int32_t place_of(std::int32_t node) const {
    const auto begin = nodes_.begin() + last_.first;
    return std::int32_t(std::find(begin, nodes_.end(), node) - begin);
  }

  std::vector<std::int32_t> nodes_;
  PatchRange last_;
};

}  // namespace lefort::fem
