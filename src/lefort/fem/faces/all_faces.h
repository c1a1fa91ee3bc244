/// \file
/// The closed set of face shapes, and the geometry of a face in space.
///
/// To sum a load over a face whose nodes are at x:
///
///     std::visit([&]<class Shape>(const Shape&) {
///       const FaceNodes<Shape> x = face_nodes<Shape>(face, x_L);
///       for (const auto& point : Shape::quadrature()) {
///         const Vec3 area = area_vector_mm2(tangents<Shape>(x, point), point.weight);
///         for (int a = 0; a < Shape::kNodes; ++a) force.col(a) += -pressure * point.N[a] * area;
///       }
///     }, face_of(face.shape));
#pragma once

#include <lefort/fem/elements/all_elements.h>
#include <lefort/fem/faces/quad4.h>
#include <lefort/fem/faces/quad8.h>
#include <lefort/fem/faces/tri3.h>
#include <lefort/fem/faces/tri6.h>
#include <lefort/mesh/volume_mesh.h>

#include <span>
#include <variant>

namespace lefort::fem {

/// To add a shape: add its file to this folder and its name here.
using AnyFace = std::variant<Tri3, Quad4, Tri6, Quad8>;

/// \returns the face of this shape, for std::visit.
[[nodiscard]] inline AnyFace face_of(mesh::FaceShape shape) {
  return internal::find_shape(shape, AnyFace{});
}

/// Node positions of one face, column by column [mm].
template <class Shape>
using FaceNodes = Eigen::Matrix<double, 3, Shape::kNodes>;

/// \param x_L  positions of all nodes [mm].
template <class Shape>
[[nodiscard]] FaceNodes<Shape> face_nodes(const mesh::Face& face, std::span<const Vec3> x_L) {
  FaceNodes<Shape> x;
  for (int a = 0; a < Shape::kNodes; ++a) x.col(a) = x_L[std::size_t(face.nodes[std::size_t(a)])];
  return x;
}

/// Columns: dx/dxi and dx/deta [mm]; their cross product points outward.
template <class Shape>
[[nodiscard]] Eigen::Matrix<double, 3, 2> tangents(const FaceNodes<Shape>& x,
                                                   const QuadraturePoint<Shape::kNodes, 2>& point) {
  return x * point.dN_dxi.transpose();
}

/// \param tangents  of a point.
/// \param weight    of the point.
/// \returns the outward area vector of the point [mm^2].
[[nodiscard]] inline Vec3 area_vector_mm2(const Eigen::Matrix<double, 3, 2>& tangents,
                                          double weight) {
  return weight * tangents.col(0).cross(tangents.col(1));
}

}  // namespace lefort::fem
