/// \file
/// The matrix that assembly, linear solver and Newton hand to one another.
#pragma once

#include <Eigen/SparseCore>

namespace lefort::linear {

/// Compressed columns. A symmetric matrix holds its lower triangle alone, diagonal always present.
using SparseMatrix = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;

}  // namespace lefort::linear
