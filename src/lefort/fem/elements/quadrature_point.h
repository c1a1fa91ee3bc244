/// \file
/// What an element shape tells about one of its integration points.
///
/// A shape (tet4.h, tet10.h, ...) is an empty struct with kShape, kNodes, kPoints and quadrature();
/// all_elements.h lists them.
#pragma once

#include <Eigen/Core>

namespace lefort::fem {

template <int kNodes>
struct QuadraturePoint {
  double weight = 0.0;                      ///< Share of the reference element's volume.
  Eigen::Matrix<double, 3, kNodes> dN_dxi;  ///< Column a: gradient of N_a in reference coordinates.
};

}  // namespace lefort::fem
