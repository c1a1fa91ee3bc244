#include <lefort/fem/elements/all_elements.h>
#include <lefort/fem/elements/fine_quadrature.h>
#include <lefort/fem/elements/gradient_products.h>
#include <lefort/verify/error_norms.h>

#include <cmath>
#include <variant>

namespace lefort::verify {
namespace {

/// Calls visit(nodes of the element, point, position X, dN/dX, volume) at every fine point.
template <class Visit>
void for_each_point(const mesh::VolumeMesh& mesh, const Visit& visit) {
  for (const mesh::ElementBlock& block : mesh.blocks)
    std::visit(
        [&]<class Shape>(const Shape&) {
          const auto points = fem::fine_quadrature<Shape>();
          for (Index e = 0; e < block.element_count(); ++e) {
            const std::int32_t* nodes = block.element(e);
            Eigen::Matrix<double, 3, Shape::kNodes> X;
            for (int a = 0; a < Shape::kNodes; ++a) X.col(a) = mesh.nodes_L[std::size_t(nodes[a])];
            for (const auto& point : points) {
              const Mat3 dX_dxi = fem::sum_of_dyads<Shape::kNodes>(X.data(), point.dN_dxi.data());
              Eigen::Matrix<double, 3, Shape::kNodes> dN_dX;
              fem::multiply_columns_transposed(dX_dxi.inverse(), point.dN_dxi.data(), Shape::kNodes,
                                               dN_dX.data());
              const Vec3 at = X * point.N;
              visit(nodes, point.N, at, dN_dX, dX_dxi.determinant() * point.weight);
            }
          }
        },
        fem::element_of(block.shape));
}

}  // namespace

ErrorNorms error_norms(const mesh::VolumeMesh& mesh, const VectorX& u, const ExactField& exact) {
  double error = 0.0;
  double size = 0.0;
  double gradient_error = 0.0;
  double gradient_size = 0.0;
  for_each_point(mesh, [&](const std::int32_t* nodes, const auto& N, const Vec3& X,
                           const auto& dN_dX, double volume_mm3) {
    Vec3 found = Vec3::Zero();
    Mat3 found_gradient = Mat3::Zero();
    for (Index a = 0; a < N.size(); ++a) {
      const Vec3 u_a = u.segment<3>(3 * Index(nodes[a]));
      found += N[a] * u_a;
      found_gradient += u_a * dN_dX.col(a).transpose();
    }
    const Vec3 wanted = exact.displacement(X);
    const Mat3 wanted_gradient = exact.gradient(X);
    error += volume_mm3 * (found - wanted).squaredNorm();
    size += volume_mm3 * wanted.squaredNorm();
    gradient_error += volume_mm3 * (found_gradient - wanted_gradient).squaredNorm();
    gradient_size += volume_mm3 * wanted_gradient.squaredNorm();
  });
  return {.l2 = std::sqrt(error / size), .h1 = std::sqrt(gradient_error / gradient_size)};
}

std::vector<fem::NodalForce> nodal_forces(const mesh::VolumeMesh& mesh,
                                          const std::function<Vec3(const Vec3& X)>& body_force) {
  std::vector<fem::NodalForce> forces(mesh.nodes_L.size());
  for (std::size_t n = 0; n < forces.size(); ++n) forces[n].node = std::int32_t(n);
  for_each_point(mesh, [&](const std::int32_t* nodes, const auto& N, const Vec3& X,
                           const auto& /*dN_dX*/, double volume_mm3) {
    const Vec3 force_n = volume_mm3 * body_force(X);
    for (Index a = 0; a < N.size(); ++a) forces[std::size_t(nodes[a])].force_n += N[a] * force_n;
  });
  return forces;
}

}  // namespace lefort::verify
