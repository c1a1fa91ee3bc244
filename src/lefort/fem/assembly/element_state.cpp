#include <lefort/core/check.h>
#include <lefort/core/decompositions.h>
#include <lefort/core/parallel.h>
#include <lefort/fem/assembly/element_state.h>
#include <lefort/fem/elements/reference_element.h>
#include <lefort/fem/locking/nodal_pressure.h>
#include <lefort/fem/locking/volumetric_split.h>
#include <lefort/fem/materials/material_response.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <span>

namespace lefort::fem {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Nodal pressures and their states.
struct NodalStates {
  std::unique_ptr<NodalPressure> term;  ///< May be null.
  std::vector<NodalPressure::State> of_patch;
};

NodalStates nodal_states(const mesh::VolumeMesh& mesh, const RegionMaterials& materials,
                         const VectorX& u) {
  std::vector<Vec3> x_L(mesh.nodes_L);
  for (std::size_t n = 0; n < x_L.size(); ++n) x_L[n] += u.segment<3>(3 * Index(n));
  NodalStates states{.term = NodalPressure::build(mesh, materials), .of_patch = {}};
  if (states.term == nullptr) return states;
  states.of_patch.resize(std::size_t(states.term->item_count()));
  parallel_for(states.term->item_count(), [&](Index item) {
    states.of_patch[std::size_t(item)] = states.term->state(item, x_L);
  });
  return states;
}

/// \param change  J - 1 at the points.
/// \param number  of the element, through the blocks.
/// \returns the mean over the element.
template <class Element>
NodalPressure::State volumetric_contribution(
    const Volumetric& volume, const ReferenceElement<Element>& points,
    const Eigen::Matrix<double, Element::kPoints, 1>& change, const NodalStates& nodal,
    Index number) {
  if constexpr (kVolumeAverage<Element> == VolumeAverage::kElement) {
    double volume_mm3 = 0.0;
    double growth_mm3 = 0.0;
    for (std::size_t q = 0; q < points.size(); ++q) {
      volume_mm3 += points[q].volume_mm3;
      growth_mm3 += points[q].volume_mm3 * change[Index(q)];
    }
    const double mean_change = growth_mm3 / volume_mm3;
    return {volume.dU_dJ(1.0 + mean_change), volume.energy_minus_one(mean_change)};
  } else {
    return nodal.term->mean_of(number, nodal.of_patch);
  }
}

/// \param nodal   null with full integration.
/// \param number  of the element, through the blocks.
template <class Element>
ElementState state_of(const mesh::VolumeMesh& mesh, const std::int32_t* nodes,
                      const Material& whole, const VectorX& u, const NodalStates* nodal,
                      Index number) {
  ElementNodes<Element> X;
  ElementNodes<Element> x;
  for (int a = 0; a < Element::kNodes; ++a) {
    X.col(a) = mesh.nodes_L[std::size_t(nodes[a])];
    x.col(a) = X.col(a) + u.segment<3>(3 * Index(nodes[a]));
  }
  const auto reference = reference_element<Element>(X);
  LEFORT_CHECK(reference.has_value());

  constexpr VolumeAverage kAverage = kVolumeAverage<Element>;
  const bool is_averaged =
      nodal != nullptr && volumetric_part(whole) != nullptr && kAverage != VolumeAverage::kNone;
  const LawPart part =
      is_averaged && kAverage == VolumeAverage::kElement ? LawPart::kIsochoric : LawPart::kWhole;
  const Material material =
      is_averaged && kAverage == VolumeAverage::kCornerNodes ? law_at_points(whole) : whole;
  ElementState state{.min_volume_ratio = std::numeric_limits<double>::infinity(),
                     .stretches = Vec3::Zero()};
  Eigen::Matrix<double, Element::kPoints, 1> change;
  double volume_mm3 = 0.0;
  for (std::size_t q = 0; q < reference->size(); ++q) {
    const ReferencePoint<Element>& point = (*reference)[q];
    const Mat3 F = deformation_gradient<Element>(x, point);
    const double J = volume_ratio(F);
    if (!(J > 0.0)) return {J, Mat3::Constant(kNan), Vec3::Constant(kNan), kNan};
    state.min_volume_ratio = std::min(state.min_volume_ratio, J);
    // The singular values of F = R U are the eigenvalues of U, sorted (\cite bonet2008, 4.6.3).
    state.stretches += point.volume_mm3 * singular_values(F);
    change[Index(q)] = jacobian_minus_one(F);
    state.cauchy_mpa += point.volume_mm3 * cauchy_stress(stress(material, part, F), F);
    state.energy_density_mpa += point.volume_mm3 * energy(material, part, F);
    volume_mm3 += point.volume_mm3;
  }
  state.cauchy_mpa /= volume_mm3;
  state.stretches /= volume_mm3;
  state.energy_density_mpa /= volume_mm3;
  if constexpr (kVolumeAverage<Element> != VolumeAverage::kNone) {
    if (!is_averaged) return state;
    const NodalPressure::State volumetric = volumetric_contribution<Element>(
        *volumetric_part(whole), *reference, change, *nodal, number);
    state.cauchy_mpa.diagonal().array() += volumetric.pressure_mpa;
    state.energy_density_mpa += volumetric.energy_density_mpa;
  }
  return state;
}

}  // namespace

std::vector<ElementState> element_states(const mesh::VolumeMesh& mesh,
                                         const RegionMaterials& materials, const VectorX& u,
                                         VolumetricIntegration volumetric_integration) {
  LEFORT_CHECK(u.size() == 3 * mesh.node_count());
  const bool is_averaged = volumetric_integration == VolumetricIntegration::kMeanDilatation;
  const NodalStates nodal = is_averaged ? nodal_states(mesh, materials, u) : NodalStates{};
  std::vector<ElementState> states(std::size_t(mesh.element_count()));
  Index first = 0;
  for (const mesh::ElementBlock& block : mesh.blocks) {
    const AnyElement element = element_of(block.shape);
    parallel_for(block.element_count(), [&](Index e) {
      const auto material = materials.find(block.region[std::size_t(e)]);
      LEFORT_CHECK(material != materials.end());
      states[std::size_t(first + e)] = std::visit(
          [&]<class Element>(const Element&) {
            return state_of<Element>(mesh, block.element(e), material->second, u,
                                     is_averaged ? &nodal : nullptr, first + e);
          },
          element);
    });
    first += block.element_count();
  }
  return states;
}

}  // namespace lefort::fem
