/// \file
/// The faces around each node of the contact faces.
#pragma once

#include <lefort/contact/weighted_quadrature.h>
#include <lefort/core/types.h>
#include <lefort/mesh/volume_mesh.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lefort::contact {

/// Max number of nodes of a patch.
inline constexpr int kMaxPatchNodes = 64;

/// A face of a node patch.
struct PatchFace {
  mesh::FaceShape shape = mesh::FaceShape::kTri3;
  std::uint8_t center = 0;                          ///< Place of the patch's node in the face.
  std::array<std::uint8_t, kMaxFaceNodes> local{};  ///< Of each node: place in NodePatch::nodes.
  std::size_t first_point = 0;  ///< Number of its first quadrature point among those of all faces.
  std::size_t number = 0;       ///< Of the face, among all contact faces.
  std::uint8_t border_sides =
      0;  ///< Bit i: side i, from corner i, lies on the border: no other contact face has it.
};

/// A node with the faces around it.
struct NodePatch {
  std::vector<std::int32_t> nodes;  ///< Of its faces, ascending.
  std::uint8_t center = 0;          ///< Place of its node in `nodes`.
  std::vector<PatchFace> faces;
  std::vector<bool>
      on_border;          ///< Of each node: whether it lies on the border of the contact faces.
  double area_mm2 = 0.0;  ///< A_a, the integral of M_a over the reference surface.

  [[nodiscard]] std::int32_t node() const { return nodes[center]; }
};

/// The patches of all nodes of the contact faces, in the order of the node numbers. Immutable.
class NodePatches {
 public:
  /// \param nodes_L  all nodes in the reference configuration [mm].
  /// \param faces    of any shape; \pre no node has more than kMaxPatchNodes in its patch.
  NodePatches(std::span<const Vec3> nodes_L, std::span<const mesh::Face> faces);

  [[nodiscard]] std::size_t size() const { return patches_.size(); }
  [[nodiscard]] const NodePatch& operator[](std::size_t patch) const { return patches_[patch]; }

  /// \param point  number of the quadrature point among those of all faces.
  /// \returns A_n, the area of the reference surface that the point stands for [mm^2].
  [[nodiscard]] double area_mm2(std::size_t point) const { return areas_mm2_[point]; }
  [[nodiscard]] std::size_t point_count() const { return areas_mm2_.size(); }

 private:
  std::vector<NodePatch> patches_;
  std::vector<double> areas_mm2_;
};

}  // namespace lefort::contact
