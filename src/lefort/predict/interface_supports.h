/// \file
/// Elastic supports of the tissue from the interface map: elevated and sliding tissue on its bone,
/// rollers and foundations at the planes where the mesh ends.
#pragma once

#include <lefort/contact/support_term.h>
#include <lefort/mesh/volume_mesh.h>
#include <lefort/predict/interface_map.h>
#include <lefort/predict/prediction_options.h>

#include <vector>

namespace lefort::predict {

/// Stiffness per area of a thin elastic layer.
struct LayerStiffness {
  double normal_mpa_per_mm = 0.0;      ///< k_n = (lambda + 2 mu) / t.
  double tangential_mpa_per_mm = 0.0;  ///< k_t = mu / t.
};

/// Moduli of the layer: loose (areolar) connective tissue. Equilibrium modulus in tension of
/// subcutaneous tissue, 2.75 kPa (\cite iatridis2003); nearly incompressible.
inline constexpr double kLayerYoung_mpa = 0.00275, kLayerPoisson = 0.49;

/// A layer of thickness t between two bodies acts as springs of stiffness (lambda + 2 mu) / t along
/// its normal and mu / t along its surface, to first order in t (\cite klarbring1991; \cite
/// goland1944 for the same springs in a lap joint).
///
/// \param young_mpa     of the layer, > 0.
/// \param poisson       0 <= nu < 0.5.
/// \param thickness_mm  t > 0.
[[nodiscard]] LayerStiffness layer_stiffness(double young_mpa, double poisson, double thickness_mm);

/// Supports of all bones and planes.
struct InterfaceSupports {
  std::vector<std::vector<contact::NodalSupport>> on_segments;  ///< One list for each segment.
  std::vector<contact::NodalSupport> on_stationary;
  std::vector<contact::NodalSupport> on_planes;
};

/// Elevated tissue is not attached while the bones move: bone pushes it, and it may slide and lift
/// off. It heals to the bone where it then lies (\cite kim2004; \cite boutros2003), so that the new
/// attachment is free of stress there and does not change the equilibrium.
///
/// \param tissue         mesh at rest.
/// \param map            conditions of its boundary nodes.
/// \param segment_count  of the plan.
/// \param options        stiffness of the deep tissue beyond a plane, and element size.
/// \param boundary       thickness of layer and foundation.
[[nodiscard]] InterfaceSupports interface_supports(const mesh::VolumeMesh& tissue,
                                                   const InterfaceMap& map,
                                                   std::size_t segment_count,
                                                   const TissueOptions& options,
                                                   const BoundaryOptions& boundary);

/// \returns whether a node slides on stationary bone or is elevated from it: its distance field is
///   then needed.
[[nodiscard]] bool slides_on_stationary_bone(const InterfaceMap& map);

}  // namespace lefort::predict
