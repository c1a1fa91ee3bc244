/// \file
/// Quadrature over the faces of the tissue with weight functions of the nodes, and the division of
/// a face into triangles.
///
/// The weight functions M_a are the dual basis of the shape functions (\cite wohlmuth2000; \cite
/// popp2012, section 3.2): integral of M_a N_b = 0 for a != b on a flat face with parallel sides,
/// and they sum to one. The weighted gap of a node is then the gap at the node wherever the gap
/// varies linearly on the faces around it; only curvature is averaged. On quadratic faces the shape
/// functions of the corners have an integral of zero or less. On such faces every M_a is therefore
/// dual to the linear hat functions on the division of the face into triangles (\cite puso2008). On
/// quad8 this holds approximately: the functions of the center are divided between the mid-edge
/// nodes.
#pragma once

#include <lefort/contact/face_quadrature.h>
#include <lefort/mesh/volume_mesh.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lefort::contact {

/// A point of the reference face, with the values of shape and weight functions.
struct WeightedPoint {
  QuadraturePoint at;
  std::array<double, kMaxFaceNodes> M{};
};

/// A vertex of the division of a face: a node, or the center of a quadrilateral.
struct DivisionVertex {
  std::array<double, kMaxFaceNodes> N{};    ///< Shape functions there.
  std::array<double, kMaxFaceNodes> hat{};  ///< Hat functions of the nodes there; they sum to one.
};

/// A face divided into triangles between its nodes, counter-clockwise as the face.
struct FaceDivision {
  std::vector<DivisionVertex> vertices;  ///< The nodes come first, in their order.
  std::vector<std::array<std::uint8_t, 3>> triangles;
};

/// \returns quadrature points with weight functions.
[[nodiscard]] std::span<const WeightedPoint> weighted_quadrature(mesh::FaceShape shape);

/// \returns the division of a face of this shape.
[[nodiscard]] const FaceDivision& face_division(mesh::FaceShape shape);

}  // namespace lefort::contact
