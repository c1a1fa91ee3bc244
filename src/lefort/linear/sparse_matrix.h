/// \file
/// The sparse matrix type of assembly, linear solvers and Newton's method.
#pragma once

#include <Eigen/SparseCore>

namespace lefort::linear {

/// Compressed columns. Of a symmetric matrix only the lower triangle is stored, with the whole
/// diagonal.
using SparseMatrix = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;

}  // namespace lefort::linear
