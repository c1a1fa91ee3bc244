/// \file
/// Numbers of the free displacement components.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/fem/assembly/boundary_conditions.h>

#include <cstdint>
#include <span>
#include <vector>

namespace lefort::fem {

/// Numbers all components by 3 * node + component, and the free ones in the same order without
/// gaps. Vectors named `all` have the length 3 * node_count(), those named `free` free_count().
class DofMap {
 public:
  /// \param node_count  number of nodes.
  /// \param prescribed  prescribed components. Their values are checked but not stored, so that one
  ///   map serves a whole load path.
  /// \returns the map, or kInvalidArgument if a node or component does not exist, a displacement is
  ///   not finite, or one component is prescribed twice with different displacements.
  [[nodiscard]] static Result<DofMap> build(Index node_count,
                                            std::span<const PrescribedDisplacement> prescribed);

  [[nodiscard]] Index node_count() const { return Index(free_from_all_.size()) / 3; }
  [[nodiscard]] Index free_count() const { return Index(all_from_free_.size()); }

  /// \returns the free number of component `all`, or -1 if it is prescribed.
  [[nodiscard]] std::int32_t free_number(Index all) const {
    return free_from_all_[std::size_t(all)];
  }

  /// \returns the entries of `all` at the free components.
  [[nodiscard]] VectorX free_part(const VectorX& all) const;

  /// \returns `all` with its free entries replaced by those of `free`.
  [[nodiscard]] VectorX with_free_part(const VectorX& all, const VectorX& free) const;

  /// \param all         displacements of all components [mm].
  /// \param prescribed  \pre its components are prescribed in this map.
  /// \returns `all` with the prescribed displacements.
  [[nodiscard]] VectorX with_prescribed(const VectorX& all,
                                        std::span<const PrescribedDisplacement> prescribed) const;

 private:
  DofMap() = default;

  std::vector<std::int32_t> free_from_all_;
  std::vector<std::int32_t> all_from_free_;
};

}  // namespace lefort::fem
