/// \file
/// The elements of a boundary layer between its outer and its inner surface.
#pragma once

#include <lefort/core/types.h>
#include <lefort/mesh/internal/layer_surface.h>
#include <lefort/mesh/volume_mesh.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace lefort::mesh::internal {

/// A corner of an element of the layer.
struct LayerCorner {
  std::int32_t node;  ///< Of the covered surface.
  int level;          ///< 0 at the outer surface, the number of layers at the inner one.
};

/// The layer by its outer surface, and a direction and a thickness per node. A node of zero
/// thickness is single: its outer and its inner copy are the same node.
class LayerElements {
 public:
  /// \param surface  the outer surface; must outlive this object.
  /// \param inwards  one unit vector or zero per node of the mesh (internal/layer_directions.h).
  /// \param layers   how many elements lie one below the other.
  LayerElements(const LayerSurface& surface, std::vector<Vec3> inwards, int layers)
      : surface_(surface),
        inwards_(std::move(inwards)),
        thickness_mm_(surface.nodes_L.size(), 0.0),
        layers_(layers) {}

  [[nodiscard]] const std::vector<Vec3>& inwards() const { return inwards_; }
  [[nodiscard]] bool is_single(std::size_t node) const { return thickness_mm_[node] == 0.0; }
  [[nodiscard]] double thickness_mm(std::size_t node) const { return thickness_mm_[node]; }
  void set_thickness_mm(std::size_t node, double thickness_mm) {
    thickness_mm_[node] = thickness_mm;
  }

  /// \returns the displacement of the node from the outer to the inner surface [mm].
  [[nodiscard]] Vec3 displacement(std::size_t node) const {
    return thickness_mm_[node] * inwards_[node];
  }

  /// \returns the smallest scaled Jacobian of the elements under a face, 1 if there are none.
  [[nodiscard]] double min_scaled_jacobian(const Face3& face) const;

  /// Adds the elements to a mesh.
  ///
  /// \param inner   one block of kTet4, whose covered nodes lie on the inner surface.
  /// \param region  of the layer's elements.
  /// \returns the tetrahedra, those of the layer last, then pyramids and wedges if there are any.
  [[nodiscard]] VolumeMesh add_to(const VolumeMesh& inner, std::int32_t region) const;

 private:
  [[nodiscard]] Vec3 at_level(std::size_t node, int level) const {
    const double fraction = double(level) / layers_;
    return surface_.nodes_L[node] + fraction * thickness_mm_[node] * inwards_[node];
  }
  /// Calls visit(number of single corners, corners) for the elements under a face, from outside
  /// to inside: wedges, pyramids or tetrahedra for 0, 1 or 2 single corners, none for 3.
  template <class Visit>
  void for_each_element(const Face3& face, const Visit& visit) const;

  const LayerSurface& surface_;
  std::vector<Vec3> inwards_;
  std::vector<double> thickness_mm_;
  int layers_;
};

}  // namespace lefort::mesh::internal
