#include <lefort/core/check.h>
#include <lefort/core/decompositions.h>
#include <lefort/core/parallel.h>
#include <lefort/fem/assembly/element_state.h>
#include <lefort/fem/elements/all_elements.h>
#include <lefort/fem/elements/reference_element.h>
#include <lefort/fem/locking/averaged_nodal_pressure.h>
#include <lefort/fem/locking/dilatation_modes.h>
#include <lefort/fem/locking/elements_in_thick_parts.h>
#include <lefort/fem/locking/smoothed_strain_term.h>
#include <lefort/fem/locking/smoothing_domains.h>
#include <lefort/fem/materials/material_response.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <span>

namespace lefort::fem {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Averages over several elements and their states.
struct Averages {
  std::unique_ptr<AveragedNodalPressure> volume;  ///< May be null.
  std::vector<AveragedNodalPressure::State> of_patch;
  std::unique_ptr<SmoothedStrainTerm> strain;  ///< May be null.
  std::vector<SmoothedStrainTerm::State> of_group;
  std::vector<char> is_in_thick_part;  ///< elements_in_thick_parts().
};

template <class Term>
auto states_of(const Term* term, std::span<const Vec3> x_L) {
  std::vector<typename Term::State> states(term == nullptr ? 0 : std::size_t(term->item_count()));
  parallel_for(Index(states.size()),
               [&](Index item) { states[std::size_t(item)] = term->state(item, x_L); });
  return states;
}

Averages averages_of(const mesh::VolumeMesh& mesh, const RegionMaterials& materials,
                     const VectorX& u) {
  std::vector<Vec3> x_L(mesh.nodes_L);
  for (std::size_t n = 0; n < x_L.size(); ++n) x_L[n] += u.segment<3>(3 * Index(n));
  Averages averages{.volume = AveragedNodalPressure::build(mesh, materials),
                    .of_patch = {},
                    .strain = SmoothedStrainTerm::build(mesh, materials),
                    .of_group = {},
                    .is_in_thick_part = elements_in_thick_parts(mesh)};
  averages.of_patch = states_of(averages.volume.get(), x_L);
  averages.of_group = states_of(averages.strain.get(), x_L);
  return averages;
}

/// Contribution of the averaged volume change to the state of one element.
template <class Element>
struct VolumetricContribution {
  using PerPoint = Eigen::Matrix<double, Element::kPoints, 1>;
  PerPoint pressure;  ///< At the points [MPa].
  double energy_mj = 0.0;
};

/// \param X       reference positions of the nodes [mm].
/// \param change  J - 1 at the points.
/// \param number  of the element, through the blocks.
template <class Element>
VolumetricContribution<Element> volumetric_contribution(
    const Material& material, const ElementNodes<Element>& X,
    const ReferenceElement<Element>& points,
    const Eigen::Matrix<double, Element::kPoints, 1>& change, const Averages& averages,
    Index number) {
  if constexpr (kDilatationModes < Element >> 0) {
    bool is_in_thick_part = false;
    if constexpr (kHasPointwiseBulk<Element>)
      is_in_thick_part = averages.is_in_thick_part[std::size_t(number)] != 0;
    const auto response =
        volume_response<Element>(split_volumetric<Element>(material, is_in_thick_part), points,
                                 dilatation_modes<Element>(X, points), change);
    if (!response) return {VolumetricContribution<Element>::PerPoint::Constant(kNan), kNan};
    return {response->pressure, response->energy_mj};
  } else {
    double volume_mm3 = 0.0;
    for (const ReferencePoint<Element>& point : points) volume_mm3 += point.volume_mm3;
    double pressure_mpa = 0.0;
    double density_mpa = 0.0;
    int count = 0;
    for (const std::int32_t patch : averages.volume->patches_of(number)) {
      if (patch < 0) continue;
      const AveragedNodalPressure::State& state = averages.of_patch[std::size_t(patch)];
      pressure_mpa += state.pressure_mpa;
      density_mpa += state.energy_density_mpa;
      ++count;
    }
    return {VolumetricContribution<Element>::PerPoint::Constant(pressure_mpa / count),
            density_mpa / count * volume_mm3};
  }
}

/// Adds the stress and energy of the smoothing domains of an element; its own are reduced to the
/// fraction kElementStabilizationFraction.
void add_smoothing_domains(const Averages& averages, Index number, ElementState& state) {
  state.cauchy_mpa *= kElementStabilizationFraction;
  state.energy_density_mpa *= kElementStabilizationFraction;
  for (const SmoothedStrainTerm::ElementDomain& domain : averages.strain->domains_of(number)) {
    const double fraction = (1.0 - kElementStabilizationFraction) * domain.fraction;
    const SmoothedStrainTerm::State& of_group = averages.of_group[std::size_t(domain.item)];
    state.cauchy_mpa += fraction * of_group.cauchy_mpa;
    state.energy_density_mpa += fraction * of_group.energy_density_mpa;
  }
}

/// \param averages  null with full integration.
/// \param number    of the element, through the blocks.
template <class Element>
ElementState state_of(const mesh::VolumeMesh& mesh, const std::int32_t* nodes,
                      const Material& whole, const VectorX& u, const Averages* averages,
                      Index number) {
  ElementNodes<Element> X;
  ElementNodes<Element> x;
  for (int a = 0; a < Element::kNodes; ++a) {
    X.col(a) = mesh.nodes_L[std::size_t(nodes[a])];
    x.col(a) = X.col(a) + u.segment<3>(3 * Index(nodes[a]));
  }
  const auto reference = reference_element<Element>(X);
  LEFORT_CHECK(reference.has_value());

  const bool is_averaged = averages != nullptr && volumetric_part(whole) != nullptr;
  constexpr bool kHasModes = kDilatationModes < Element >> 0;
  const LawPart part = is_averaged && kHasModes ? LawPart::kIsochoric : LawPart::kWhole;
  const Material material =
      is_averaged && !kHasModes ? element_law_without_nodal_part(whole) : whole;
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
  if (!is_averaged) return state;

  if constexpr (kSmoothingDomains < Element >> 0) add_smoothing_domains(*averages, number, state);
  const auto volumetric =
      volumetric_contribution<Element>(whole, X, *reference, change, *averages, number);
  for (std::size_t q = 0; q < reference->size(); ++q)
    state.cauchy_mpa.diagonal().array() +=
        (*reference)[q].volume_mm3 / volume_mm3 * volumetric.pressure[Index(q)];
  state.energy_density_mpa += volumetric.energy_mj / volume_mm3;
  return state;
}

}  // namespace

std::vector<ElementState> element_states(const mesh::VolumeMesh& mesh,
                                         const RegionMaterials& materials, const VectorX& u,
                                         VolumetricIntegration volumetric_integration) {
  LEFORT_CHECK(u.size() == 3 * mesh.node_count());
  const bool is_averaged = volumetric_integration == VolumetricIntegration::kMeanDilatation;
  const Averages averages = is_averaged ? averages_of(mesh, materials, u) : Averages{};
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
                                     is_averaged ? &averages : nullptr, first + e);
          },
          element);
    });
    first += block.element_count();
  }
  return states;
}

}  // namespace lefort::fem
