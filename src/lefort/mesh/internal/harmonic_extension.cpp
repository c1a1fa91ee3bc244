#include <lefort/core/parallel.h>
#include <lefort/mesh/internal/harmonic_extension.h>

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace lefort::mesh::internal {
namespace {

constexpr int kMaxIterations = 200;
// Of the norm of the first residual, weighted by the preconditioner. Element shapes need no more.
constexpr double kRelativeTolerance = 1e-3;

double inner_product(const Displacements& a, const Displacements& b) {
  return deterministic_sum(a.rows(), 0.0, [&](Index n) { return a.row(n).dot(b.row(n)); });
}

}  // namespace

HarmonicExtension::HarmonicExtension(const VolumeMesh& tets, const LayerConstraints& constraints)
    : constraints_(constraints) {
  std::vector<Eigen::Triplet<double, Index>> entries;
  entries.reserve(std::size_t(16 * tets.element_count()));
  for (Index e = 0; e < tets.element_count(); ++e) {
    const std::int32_t* nodes = tets.blocks[0].element(e);
    Mat3 edges;
    for (Index n = 0; n < 3; ++n)
      edges.col(n) = tets.nodes_L[std::size_t(nodes[std::size_t(n) + 1])] -
                     tets.nodes_L[std::size_t(nodes[0])];
    Eigen::Matrix<double, 4, 3> gradients;
    gradients.bottomRows<3>() = edges.inverse();
    gradients.row(0) = -gradients.bottomRows<3>().colwise().sum();
    const Eigen::Matrix4d part = edges.determinant() / 6.0 * gradients * gradients.transpose();
    for (Index i = 0; i < 4; ++i)
      for (Index j = 0; j < 4; ++j)
        entries.emplace_back(nodes[std::size_t(i)], nodes[std::size_t(j)], part(i, j));
  }
  laplacian_.resize(tets.node_count(), tets.node_count());
  laplacian_.setFromTriplets(entries.begin(), entries.end());
  diagonal_ = laplacian_.diagonal();
  diagonal_ = (diagonal_.array() > 0.0).select(diagonal_, 1.0);  // Nodes without elements.
}

Displacements HarmonicExtension::solve(const Displacements& prescribed) const {
  Displacements u = prescribed;
  Displacements residual = free_part(-times_laplacian(u));
  Displacements z = free_part(residual.array().colwise() / diagonal_.array());
  Displacements direction = z;
  double rz = inner_product(residual, z);
  const double wanted = kRelativeTolerance * kRelativeTolerance * rz;
  for (int i = 0; i < kMaxIterations && rz > wanted; ++i) {
    const Displacements product = free_part(times_laplacian(direction));
    const double step = rz / inner_product(direction, product);
    u += step * direction;
    residual -= step * product;
    z = free_part(residual.array().colwise() / diagonal_.array());
    const double rz_before = std::exchange(rz, inner_product(residual, z));
    direction = z + rz / rz_before * direction;
  }
  return u;
}

Displacements HarmonicExtension::times_laplacian(const Displacements& u) const {
  Displacements product(u.rows(), 3);
  parallel_for(u.rows(), [&](Index n) {
    Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
    for (decltype(laplacian_)::InnerIterator entry(laplacian_, n); entry; ++entry)
      sum += entry.value() * u.row(entry.col());
    product.row(n) = sum;
  });
  return product;
}

Displacements HarmonicExtension::free_part(Displacements u) const {
  parallel_for(u.rows(), [&](Index n) {
    const auto node = std::size_t(n);
    u.row(n) = constraints_.is_fixed(node)
                   ? Eigen::RowVector3d::Zero().eval()
                   : constraints_.project(node, u.row(n).transpose()).transpose().eval();
  });
  return u;
}

}  // namespace lefort::mesh::internal
