/// \file
/// Faces of the tissue that may touch a bone, divided into patches with quadrature points.
#pragma once

#include <lefort/contact/face_quadrature.h>
#include <lefort/core/types.h>
#include <lefort/mesh/volume_mesh.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lefort::contact {

/// \param nodes_L  nodes in the reference configuration [mm].
/// \param u        their displacements, three per node [mm]; as in fem::Assembler.
/// \returns the current positions of the nodes [mm].
[[nodiscard]] std::vector<Vec3> displaced(std::span<const Vec3> nodes_L, const VectorX& u);

/// A face.
struct ContactPatch {
  std::array<std::int32_t, kMaxFaceNodes> nodes{};
  std::uint8_t count = 0;
  std::uint8_t rule = 0;        ///< Argument of face_quadrature().
  std::size_t first_point = 0;  ///< Number of its first point among the points of all patches.

  [[nodiscard]] std::span<const std::int32_t> span() const { return {nodes.data(), count}; }
};

/// Positions of the nodes of one patch.
struct PatchPositions {
  std::array<Vec3, kMaxFaceNodes> x_L;
  std::size_t count = 0;

  /// \param nodes  of the patch.
  /// \param all_L  positions of all nodes of the mesh.
  PatchPositions(std::span<const std::int32_t> nodes, std::span<const Vec3> all_L)
      : count(nodes.size()) {
    for (std::size_t a = 0; a < count; ++a) x_L[a] = all_L[std::size_t(nodes[a])];
  }
  [[nodiscard]] std::span<const Vec3> span() const { return {x_L.data(), count}; }
};

/// Patches and their quadrature points. Immutable.
class ContactSurface {
 public:
  /// \param nodes_L  all nodes in the reference configuration [mm].
  /// \param faces    of any shape; each is a patch with the points of face_quadrature().
  ContactSurface(std::span<const Vec3> nodes_L, std::span<const mesh::Face> faces);

  [[nodiscard]] std::span<const ContactPatch> patches() const { return patches_; }
  [[nodiscard]] const ContactPatch& patch(std::size_t number) const { return patches_[number]; }
  [[nodiscard]] std::size_t point_count() const { return areas_mm2_.size(); }

  /// \param point  number of the point among those of all patches.
  /// \returns A_n, the area of the reference surface that the point stands for [mm^2].
  [[nodiscard]] double area_mm2(std::size_t point) const { return areas_mm2_[point]; }

 private:
  std::vector<ContactPatch> patches_;
  std::vector<double> areas_mm2_;
};

}  // namespace lefort::contact
