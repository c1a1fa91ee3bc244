#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/fem/element_state.h>
#include <lefort/fem/elements/all_elements.h>
#include <lefort/fem/reference_element.h>

#include <Eigen/SVD>

#include <algorithm>
#include <limits>

namespace lefort::fem {
namespace {

template <class Element>
ElementState state_of(const mesh::VolumeMesh& mesh, const std::int32_t* nodes,
                      const Material& material, const VectorX& u) {
  ElementNodes<Element> X;
  ElementNodes<Element> x;
  for (int a = 0; a < Element::kNodes; ++a) {
    X.col(a) = mesh.nodes_L[std::size_t(nodes[a])];
    x.col(a) = X.col(a) + u.segment<3>(3 * Index(nodes[a]));
  }
  const auto reference = reference_element<Element>(X);
  LEFORT_CHECK(reference.has_value());

  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  ElementState state{.min_volume_ratio = std::numeric_limits<double>::infinity(),
                     .stretches = Vec3::Zero()};
  double volume_mm3 = 0.0;
  for (const ReferencePoint<Element>& point : *reference) {
    const Mat3 F = deformation_gradient<Element>(x, point);
    const double J = volume_ratio(F);
    if (!(J > 0.0)) return {J, Mat3::Constant(kNan), Vec3::Constant(kNan), kNan};
    state.min_volume_ratio = std::min(state.min_volume_ratio, J);
    // The singular values of F = R U are the eigenvalues of U, sorted (\cite bonet2008, 4.6.3).
    state.stretches += point.volume_mm3 * Eigen::JacobiSVD<Mat3>(F).singularValues();
    std::visit(
        [&](const auto& law) {
          state.cauchy_mpa += point.volume_mm3 * cauchy_stress(law.stress(F), F);
          state.energy_density_mpa += point.volume_mm3 * law.energy(F);
        },
        material);
    volume_mm3 += point.volume_mm3;
  }
  state.cauchy_mpa /= volume_mm3;
  state.stretches /= volume_mm3;
  state.energy_density_mpa /= volume_mm3;
  return state;
}

}  // namespace

std::vector<ElementState> element_states(const mesh::VolumeMesh& mesh,
                                         const RegionMaterials& materials, const VectorX& u) {
  LEFORT_CHECK(u.size() == 3 * mesh.node_count());
  std::vector<ElementState> states(std::size_t(mesh.element_count()));
  Index first = 0;
  for (const mesh::ElementBlock& block : mesh.blocks) {
    const AnyElement element = element_of(block.shape);
    parallel_for(block.element_count(), [&](Index e) {
      const auto material = materials.find(block.region[std::size_t(e)]);
      LEFORT_CHECK(material != materials.end());
      states[std::size_t(first + e)] = std::visit(
          [&]<class Element>(const Element&) {
            return state_of<Element>(mesh, block.element(e), material->second, u);
          },
          element);
    });
    first += block.element_count();
  }
  return states;
}

}  // namespace lefort::fem
