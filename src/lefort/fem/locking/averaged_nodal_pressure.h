/// \file
/// Volumetric energy of elements that average the change of volume around nodes
/// (volumetric_integration.h).
#pragma once

#include <lefort/core/types.h>
#include <lefort/fem/assembly/force_term.h>
#include <lefort/fem/locking/node_list_builder.h>
#include <lefort/fem/materials/material.h>
#include <lefort/mesh/volume_mesh.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace lefort::fem {

/// Averaged nodal pressure (\cite bonet1998), with averages at the innermost nodes of each element:
///
///   W  = sum over patches a of V_a U(v_a / V_a),   V_a = sum over e of s_ae V_e,
///                                                  v_a = sum over e of s_ae v_e
///   dW = sum over elements of (sum over a of s_ae p_a) cof F : dF dV,   p_a = U'(v_a / V_a)
///
/// V_e is the reference volume of an element and v_e its current volume. U is the volumetric energy
/// of the law without the part that the elements keep (kNodalStabilizationFactor).
///
/// A patch is a node with the elements around it that belong to one region, have a decoupled law,
/// and are of a shape that averages around nodes. Each element belongs, with equal weights s_ae
/// whose sum is 1, to the patches of its innermost nodes: interior nodes of its region if it has
/// any; else nodes on a face of the region; else on an edge; else in a corner. An item is a patch.
/// It couples all nodes of its elements; if these are more than kMaxLocalNodes, the elements are
/// divided between several patches.
///
/// With averages also at boundary nodes there would be one volume constraint more than layers of
/// elements, which would excite an alternating (checkerboard) change of volume. Weights that vary
/// within an element would constrain more than its volume. Both lock.
class AveragedNodalPressure final : public ForceTerm {
 public:
  /// \param mesh       accepted by make_element_terms(); not referred to afterwards.
  /// \param materials  accepted by make_element_terms(); not referred to afterwards.
  /// \returns the term, or null if no element averages around nodes.
  [[nodiscard]] static std::unique_ptr<AveragedNodalPressure> build(
      const mesh::VolumeMesh& mesh, const RegionMaterials& materials);

  [[nodiscard]] Index item_count() const override { return Index(patches_.size()); }
  [[nodiscard]] std::span<const std::int32_t> nodes(Index item) const override;
  [[nodiscard]] bool evaluate(Index item, std::span<const Vec3> x_L,
                              LocalEquations& local) const override;

  /// Pressure and energy of one patch.
  struct State {
    double pressure_mpa = 0.0;        ///< U', tension positive; NaN if J <= 0 at a point.
    double energy_density_mpa = 0.0;  ///< U, per reference volume; NaN if J <= 0 at a point.
  };

  /// \param item  number of the patch.
  /// \param x_L   current positions of all nodes [mm].
  [[nodiscard]] State state(Index item, std::span<const Vec3> x_L) const;

  /// \param number  of the element, through the blocks.
  /// \returns for each node of the element the patch around this node to which the element belongs,
  ///   or -1 if the node is not one of its innermost; empty if the element does not average around
  ///   nodes.
  [[nodiscard]] std::span<const std::int32_t> patches_of(Index number) const;

 private:
  /// Counts and offsets of one element.
  struct ElementGeometry {
    std::int32_t points = 0;
    std::int32_t nodes = 0;
    Index first_gradient = 0;  ///< In gradients_: for each point, for each node.
    Index first_volume = 0;    ///< In volumes_mm3_: for each point.
  };

  /// One element of a patch.
  struct PatchElement {
    std::int32_t element = 0;
    /// In local_nodes_: for each node of the element, its local number in the patch.
    std::int32_t first_local = 0;
    double fraction = 0.0;  ///< s_ae.
  };

  struct NodePatch {
    Volumetric volume;
    double volume_mm3 = 0.0;  ///< V_a.
    PatchRange nodes;         ///< In patch_nodes_.
    std::int32_t first_element = 0;
    std::int32_t element_count = 0;
  };

  class Builder;

  AveragedNodalPressure() = default;

  /// Calls f(F, s_ae dV, gradients dN/dX, local node numbers) for every point of the patch.
  template <class Function>
  void for_each_point(const NodePatch& patch, std::span<const Vec3> x_L, const Function& f) const;

  /// \returns v_a / V_a - 1, or nothing if J <= 0 at a point, or NaN.
  [[nodiscard]] std::optional<double> mean_change(const NodePatch& patch,
                                                  std::span<const Vec3> x_L) const;

  std::vector<Vec3> gradients_;      ///< dN_a/dX.
  std::vector<double> volumes_mm3_;  ///< dV.
  std::vector<ElementGeometry> geometries_;
  std::vector<PatchElement> patch_elements_;
  std::vector<std::uint8_t> local_nodes_;
  std::vector<std::int32_t> patch_nodes_;
  std::vector<NodePatch> patches_;
  std::vector<std::int32_t> end_of_corners_;  ///< Of each element of the mesh, in patch_of_corner_.
  std::vector<std::int32_t> patch_of_corner_;  ///< See patches_of().
};

}  // namespace lefort::fem
