#include <lefort/core/check.h>
#include <lefort/fem/elements/corner_shape.h>
#include <lefort/fem/elements/reference_element.h>
#include <lefort/fem/locking/lone_corners.h>
#include <lefort/verify/inf_sup.h>

#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace lefort::verify {
namespace {

using fem::ElementNodes;

/// An eigenvalue below it counts as zero. Those of the pairs of the report are above 1e-3.
constexpr double kZeroEigenvalue = 1e-9;

/// Consecutive numbers of the nodes that take part; -1 for the others.
struct Numbering {
  std::vector<Index> of_node;
  Index count = 0;

  void add(std::int32_t node) {
    Index& number = of_node[std::size_t(node)];
    if (number < 0) number = count++;
  }
};

Numbering free_nodes(const mesh::VolumeMesh& mesh, const std::string& held) {
  std::vector<bool> is_held(mesh.nodes_L.size(), false);
  for (const std::int32_t node : mesh.node_sets.at(held)) is_held[std::size_t(node)] = true;
  Numbering free{.of_node = std::vector<Index>(mesh.nodes_L.size(), -1)};
  for (std::int32_t node = 0; node < mesh.node_count(); ++node)
    if (!is_held[std::size_t(node)]) free.add(node);
  return free;
}

int corner_count(mesh::ElementShape shape) {
  return std::visit([]<class Element>(const Element&) { return fem::CornerShape<Element>::kNodes; },
                    fem::element_of(shape));
}

/// \returns the number of elements whose corner each node is.
std::vector<int> elements_of_corners(const mesh::VolumeMesh& mesh) {
  std::vector<int> counts(mesh.nodes_L.size(), 0);
  for (const mesh::ElementBlock& block : mesh.blocks)
    for (Index e = 0; e < block.element_count(); ++e)
      for (int a = 0; a < corner_count(block.shape); ++a)
        ++counts[std::size_t(block.element(e)[a])];
  return counts;
}

/// \returns T, so that the pressure functions of the element are T N.
template <class Element>
Eigen::MatrixXd continuous_functions(const std::int32_t* nodes, std::span<const int> counts) {
  constexpr int kCorners = fem::CornerShape<Element>::kNodes;
  if constexpr (!fem::kSharesLoneCorners<Element>) {
    return Eigen::MatrixXd::Identity(kCorners, kCorners);
  } else {
    fem::LoneCorners is_lone{};
    for (std::size_t a = 0; a < kCorners; ++a) is_lone[a] = counts[std::size_t(nodes[a])] == 1;
    return fem::pressure_functions(is_lone);
  }
}

/// The nodes with a continuous pressure.
Numbering pressure_nodes(const mesh::VolumeMesh& mesh, std::span<const int> counts) {
  Numbering corners{.of_node = std::vector<Index>(mesh.nodes_L.size(), -1)};
  for (const mesh::ElementBlock& block : mesh.blocks)
    for (Index e = 0; e < block.element_count(); ++e)
      std::visit(
          [&]<class Element>(const Element&) {
            const Eigen::MatrixXd T = continuous_functions<Element>(block.element(e), counts);
            for (Index a = 0; a < T.rows(); ++a)
              if (!T.row(a).isZero()) corners.add(block.element(e)[a]);
          },
          fem::element_of(block.shape));
  return corners;
}

/// Matrices of the test; those of the displacements are the same for the three components.
struct Matrices {
  Eigen::SparseMatrix<double> A;     ///< Free node by free node.
  std::array<Eigen::MatrixXd, 3> B;  ///< Per component: free node by pressure.
  Eigen::MatrixXd M;                 ///< Pressure by pressure.
};

class Builder {
 public:
  Builder(const mesh::VolumeMesh& mesh, PressureSpace pressure, const std::string& held)
      : mesh_(mesh),
        pressure_(pressure),
        free_(free_nodes(mesh, held)),
        corner_elements_(elements_of_corners(mesh)),
        corners_(pressure_nodes(mesh, corner_elements_)) {
    const Index per_element = pressure == PressureSpace::kElementLinear ? 4 : 1;
    const Index count = pressure == PressureSpace::kContinuous ? corners_.count
                                                               : per_element * mesh.element_count();
    matrices_.M = Eigen::MatrixXd::Zero(count, count);
    for (Eigen::MatrixXd& B : matrices_.B) B = Eigen::MatrixXd::Zero(free_.count, count);
  }

  Matrices build() {
    Index number = 0;
    for (const mesh::ElementBlock& block : mesh_.blocks)
      for (Index e = 0; e < block.element_count(); ++e)
        std::visit([&]<class Element>(const Element&) { add<Element>(block.element(e), number++); },
                   fem::element_of(block.shape));
    matrices_.A.resize(free_.count, free_.count);
    matrices_.A.setFromTriplets(entries_.begin(), entries_.end());
    return std::move(matrices_);
  }

 private:
  /// Numbers of the pressures of one element, and their values at one point.
  struct Pressures {
    std::vector<Index> numbers = {};
    VectorX values = {};
  };

  /// \param X  nodes of the element [mm].
  /// \param N  shape functions at the point.
  template <class Element>
  Pressures pressures_at(const std::int32_t* nodes, Index number, const ElementNodes<Element>& X,
                         const Eigen::Matrix<double, Element::kNodes, 1>& N) const {
    if (pressure_ == PressureSpace::kElementConstant) return {{number}, VectorX::Ones(1)};
    if (pressure_ == PressureSpace::kElementLinear) {
      Eigen::Vector4d values;
      const double size_mm = (X.colwise() - X.col(0)).colwise().norm().maxCoeff();
      values << 1.0, (X * N - X.rowwise().mean()) / size_mm;
      return {{4 * number, 4 * number + 1, 4 * number + 2, 4 * number + 3}, values};
    }
    const VectorX values =
        continuous_functions<Element>(nodes, corner_elements_) * fem::corner_functions<Element>(N);
    Pressures found;
    std::vector<double> kept;
    for (int a = 0; a < fem::CornerShape<Element>::kNodes; ++a)
      if (const Index of_corner = corners_.of_node[std::size_t(nodes[a])]; of_corner >= 0) {
        found.numbers.push_back(of_corner);
        kept.push_back(values[a]);
      }
    found.values = Eigen::Map<const VectorX>(kept.data(), Index(kept.size()));
    return found;
  }

  template <class Element>
  void add(const std::int32_t* nodes, Index number) {
    ElementNodes<Element> X;
    for (int a = 0; a < Element::kNodes; ++a) X.col(a) = mesh_.nodes_L[std::size_t(nodes[a])];
    const auto points = fem::reference_element<Element>(X);
    LEFORT_CHECK(points.has_value());
    const auto quadrature = Element::quadrature();
    for (std::size_t q = 0; q < points->size(); ++q) {
      const auto& [dN_dX, dV] = (*points)[q];
      const Pressures p = pressures_at<Element>(nodes, number, X, quadrature[q].N);
      for (std::size_t i = 0; i < p.numbers.size(); ++i) {
        const Index column = p.numbers[i];
        for (std::size_t j = 0; j < p.numbers.size(); ++j)
          matrices_.M(column, p.numbers[j]) += dV * p.values[Index(i)] * p.values[Index(j)];
        for (int a = 0; a < Element::kNodes; ++a)
          if (const Index row = free_.of_node[std::size_t(nodes[a])]; row >= 0)
            for (int c = 0; c < 3; ++c)
              matrices_.B[std::size_t(c)](row, column) += dV * p.values[Index(i)] * dN_dX(c, a);
      }
      for (int a = 0; a < Element::kNodes; ++a)
        for (int b = 0; b < Element::kNodes; ++b) {
          const Index row = free_.of_node[std::size_t(nodes[a])];
          const Index column = free_.of_node[std::size_t(nodes[b])];
          if (row >= 0 && column >= 0)
            entries_.emplace_back(int(row), int(column), dV * dN_dX.col(a).dot(dN_dX.col(b)));
        }
    }
  }

  const mesh::VolumeMesh& mesh_;
  PressureSpace pressure_;
  Numbering free_;
  std::vector<int> corner_elements_;  ///< Elements whose corner each node is.
  Numbering corners_;                 ///< The nodes with a continuous pressure.
  std::vector<Eigen::Triplet<double>> entries_;
  Matrices matrices_;
};

}  // namespace

InfSup inf_sup_number(const mesh::VolumeMesh& mesh, PressureSpace pressure,
                      const std::string& held) {
  const Matrices of_mesh = Builder(mesh, pressure, held).build();
  const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> factor(of_mesh.A);
  LEFORT_CHECK(factor.info() == Eigen::Success);
  Eigen::MatrixXd G = Eigen::MatrixXd::Zero(of_mesh.M.rows(), of_mesh.M.rows());
  for (const Eigen::MatrixXd& B : of_mesh.B) G.noalias() += B.transpose() * factor.solve(B);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> modes(
      G, of_mesh.M, Eigen::EigenvaluesOnly | Eigen::Ax_lBx);
  InfSup found{.number = 1.0, .zero_modes = 0, .pressures = of_mesh.M.rows()};
  for (const double value : modes.eigenvalues()) {
    if (value < kZeroEigenvalue)
      ++found.zero_modes;
    else
      found.number = std::min(found.number, std::sqrt(value));
  }
  return found;
}

}  // namespace lefort::verify
