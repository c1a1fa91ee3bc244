#include <lefort/fem/elements/all_elements.h>
#include <lefort/fem/elements/reference_element.h>
#include <lefort/verify/fiber_tension.h>

#include <cstdint>
#include <span>
#include <utility>
#include <variant>
#include <vector>

namespace lefort::verify {
namespace {

template <class Shape>
class TensionOfShape final : public FiberTension {
 public:
  /// Derivative of the fiber's current vector F f with respect to the positions of the nodes.
  struct Point {
    Eigen::Matrix<double, Shape::kNodes, 1> along;  ///< f . dN_a/dX [1/mm].
    double volume_mm3 = 0.0;
  };

  std::vector<std::int32_t> element_nodes;
  std::vector<Point> points;  ///< Shape::kPoints per element.

  [[nodiscard]] Index item_count() const override {
    return Index(element_nodes.size()) / Shape::kNodes;
  }

  [[nodiscard]] std::span<const std::int32_t> nodes(Index item) const override {
    return {element_nodes.data() + item * Shape::kNodes, std::size_t(Shape::kNodes)};
  }

  [[nodiscard]] bool evaluate(Index item, std::span<const Vec3> x_L,
                              fem::LocalEquations& local) const override {
    const Eigen::Map<const fem::ElementNodes<Shape>> x(x_L.data()->data());
    for (int q = 0; q < Shape::kPoints; ++q) {
      const Point& point = points[std::size_t(item * Shape::kPoints + q)];
      const Vec3 stretched = x * point.along;
      const double factor = tension_mpa_ * point.volume_mm3;
      local.energy_mj += 0.5 * factor * (stretched.squaredNorm() - 1.0);
      for (Index a = 0; a < Shape::kNodes; ++a) {
        local.residual_n.template segment<3>(3 * a) += factor * point.along[a] * stretched;
        if (!local.wants_stiffness() || local.tangent == fem::Tangent::kAntisymmetric) continue;
        for (Index b = 0; b < Shape::kNodes; ++b)
          local.stiffness_n_per_mm.template block<3, 3>(3 * a, 3 * b).diagonal().array() +=
              factor * point.along[a] * point.along[b];
      }
    }
    return true;
  }
};

template <class Shape>
Result<std::unique_ptr<FiberTension>> tension_of(const mesh::VolumeMesh& mesh,
                                                 const mesh::ElementBlock& block,
                                                 const std::function<Vec3(const Vec3&)>& fiber) {
  auto term = std::make_unique<TensionOfShape<Shape>>();
  term->element_nodes = block.nodes;
  for (Index e = 0; e < block.element_count(); ++e) {
    fem::ElementNodes<Shape> X;
    for (int a = 0; a < Shape::kNodes; ++a)
      X.col(a) = mesh.nodes_L[std::size_t(block.element(e)[a])];
    const auto reference = fem::reference_element<Shape>(X);
    if (!reference) return fail(ErrorCode::kMeshInvalid, "an element with fibers is inverted");
    for (int q = 0; q < Shape::kPoints; ++q) {
      const Vec3 at = X * Shape::quadrature()[std::size_t(q)].N;
      const auto& point = (*reference)[std::size_t(q)];
      term->points.push_back(
          {.along = point.dN_dX.transpose() * fiber(at), .volume_mm3 = point.volume_mm3});
    }
  }
  return term;
}

}  // namespace

Result<std::unique_ptr<FiberTension>> FiberTension::build(
    const mesh::VolumeMesh& mesh, const std::function<Vec3(const Vec3&)>& fiber) {
  if (mesh.blocks.size() != 1)
    return fail(ErrorCode::kMeshInvalid, "fibers need elements of one shape");
  const mesh::ElementBlock& block = mesh.blocks.front();
  return std::visit(
      [&]<class Shape>(const Shape&) { return tension_of<Shape>(mesh, block, fiber); },
      fem::element_of(block.shape));
}

}  // namespace lefort::verify
