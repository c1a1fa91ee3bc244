/// \file
/// Depth of a rigid point in the tissue behind the faces of a node patch.
///
/// The faces are divided into triangles (weighted_quadrature.h). With the closest point
/// P = sum_b N_b x_b of these triangles to the point v, on a face, edge or vertex:
///
///   D = |v - P| > 0 behind the faces, else there is no contact
///   dD/dx_b     = N_b n,  n = (P - v) / D       (the outward normal of a face)
///
/// The second derivatives are those of min over N of |v - sum N_b x_b|.
///
/// The condition of a point fades out towards the border of the contact faces, so that it does not
/// vanish at once where the point slides over the border. The fade is s(eta / kFadeWidth) with s(t)
/// = 3 t^2 - 2 t^3 for t < 1, else 1. eta is linear in each quarter of a triangle, 0 on the border,
/// and 1 at the other vertices and middles of edges.
#pragma once

#include <lefort/contact/bone_points.h>
#include <lefort/contact/node_patches.h>
#include <lefort/core/types.h>

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace lefort::contact {

/// Closest point of a patch to a point behind it.
struct PointDepth {
  double depth_mm = 0.0;     ///< D > 0.
  double weight = 0.0;       ///< Hat function of the patch's node at P.
  double fade = 1.0;         ///< s at P, 0 to 1.
  std::uint8_t corners = 0;  ///< Number of corners of the face, edge or vertex: 3, 2 or 1.
  std::array<Vec3, 3> gradient_L{Vec3::Zero(), Vec3::Zero(),
                                 Vec3::Zero()};  ///< dD/dx of each corner.
  /// ds/dx of each corner [1/mm].
  std::array<Vec3, 3> fade_gradient_L{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  Eigen::Matrix<double, 9, 9> hessian_L =
      Eigen::Matrix<double, 9, 9>::Zero();  ///< Of D [1/mm]; 3 rows and columns per corner.
  /// Positive semidefinite approximation of D Hess D, bounded as D goes to 0; 0 inside a face.
  Eigen::Matrix<double, 9, 9> positive_L = Eigen::Matrix<double, 9, 9>::Zero();
  /// Of each corner: the shape functions there, in the order of the nodes of the face.
  std::array<std::array<double, kMaxFaceNodes>, 3> N{};
  std::uint8_t face = 0;  ///< Index in NodePatch::faces.
};

/// A triangle of the division of a patch.
struct PatchTriangle {
  std::array<Vec3, 3> x_L;  ///< Corners [mm].
  /// Of each corner: its place in NodePatch::nodes; at the center of face f: -(f + 1).
  std::array<int, 3> keys{};
  std::uint8_t face = 0;                 ///< Index in NodePatch::faces.
  std::uint8_t number = 0;               ///< In the division of the face.
  std::array<bool, 3> border_corners{};  ///< Whether a corner lies on the border.
  std::array<bool, 3> border_edges{};    ///< Whether the edge from a corner to the next does.

  [[nodiscard]] Vec3 normal() const { return (x_L[1] - x_L[0]).cross(x_L[2] - x_L[0]); }
  /// \returns the number of the corner with this key; -1 if there is none.
  [[nodiscard]] int place_of(int key) const {
    for (int c = 0; c < 3; ++c)
      if (keys[std::size_t(c)] == key) return c;
    return -1;
  }
};

/// \param x_L  nodes of the patch [mm].
[[nodiscard]] std::vector<PatchTriangle> triangles_of(const NodePatch& patch,
                                                      std::span<const Vec3> x_L);

/// Width of the fade, as a fraction of half an edge.
inline constexpr double kFadeWidth = 0.4;

/// \param patch          the patch.
/// \param triangles      triangles_of() the patch.
/// \param v              the point and the outward normal of its bone, in frame L.
/// \param max_depth_mm   max depth.
/// \param wants_hessian  whether hessian_L and positive_L are computed.
/// \returns the depth; nothing
///   - if the point is outside the tissue, or deeper than `max_depth_mm`,
///   - if its bone is on the other side of the tissue: the normals of bone and face do not oppose
///     each other,
///   - if P lies on the border of the patch, where the hat function of its node is 0, or on the
///     border of the contact faces, where the fade is 0.
[[nodiscard]] std::optional<PointDepth> point_depth(const NodePatch& patch,
                                                    std::span<const PatchTriangle> triangles,
                                                    const BonePoint& v, double max_depth_mm,
                                                    bool wants_hessian);

}  // namespace lefort::contact
