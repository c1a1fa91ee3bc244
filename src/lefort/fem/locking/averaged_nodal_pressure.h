/// \file
/// What a change of volume costs in elements that average it around their nodes
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

/// W = sum over patches of V U(v / V),   V = sum of s V_e,   v = sum of s v_e ,
///
/// V_e and v_e being the volumes of an element, now and at rest, and U that part of the law's which
/// the elements do not keep (kNodalStabilizationFraction).
///
/// A patch is a node with the elements around it that are of one region, have a law in split form
/// and are of a shape that averages around nodes. Each element belongs, in equal shares s, to the
/// patches of those of its nodes that lie furthest inside such elements: inside before on a face,
/// on a face before on an edge, on an edge before in a corner. An item is a patch: it couples all
/// nodes of its elements. Where that would be more than kMaxLocalNodes, the elements around the
/// node are shared out over several patches.
///
/// Two things lock otherwise. Means on the border as well are one more than there are layers of
/// elements to change volume: what they ask of each layer alternates through the whole body. And
/// weights that vary within an element tell apart, in each, more than its volume.
///
/// dW = sum of p cof F : dF dV, p = sum of s p_a, p_a = U'(v / V).
class AveragedNodalPressure final : public ForceTerm {
 public:
  /// \param mesh, materials  accepted by make_element_terms(); the term does not refer to them any
  ///   more.
  /// \returns nothing if there is no such element.
  [[nodiscard]] static std::unique_ptr<AveragedNodalPressure> build(
      const mesh::VolumeMesh& mesh, const RegionMaterials& materials);

  [[nodiscard]] Index item_count() const override { return Index(patches_.size()); }
  [[nodiscard]] std::span<const std::int32_t> nodes(Index item) const override;
  [[nodiscard]] bool evaluate(Index item, std::span<const Vec3> x_L,
                              LocalEquations& local) const override;

  /// What is known at a patch.
  struct State {
    double pressure_mpa = 0.0;        ///< U', tension positive; NaN if a point is inside out.
    double energy_density_mpa = 0.0;  ///< U, per reference volume; NaN if a point is inside out.
  };

  /// \param x_L  current positions of all nodes [mm].
  [[nodiscard]] State state(Index item, std::span<const Vec3> x_L) const;

  /// For each node of element `number` (through the blocks) the patch around it to which the
  /// element belongs, or -1; empty if it takes no part. Shares in them are equal.
  [[nodiscard]] std::span<const std::int32_t> patches_of(Index number) const;

 private:
  /// One element as far as its volume goes.
  struct ElementGeometry {
    std::int32_t points = 0;
    std::int32_t nodes = 0;
    Index first_gradient = 0;  ///< In gradients_: for each point, for each node.
    Index first_volume = 0;    ///< In volumes_mm3_: for each point.
  };

  /// One element within a patch.
  struct PatchElement {
    std::int32_t part = 0;
    std::int32_t first_place = 0;  ///< In places_: for each of its nodes, its place in the patch.
    double fraction = 0.0;         ///< s.
  };

  struct NodePatch {
    Volumetric volume;
    double volume_mm3 = 0.0;  ///< V.
    PatchRange nodes;         ///< In patch_nodes_.
    std::int32_t first_member = 0;
    std::int32_t members = 0;
  };

  class Builder;

  AveragedNodalPressure() = default;

  /// Calls f(F, s dV, gradients of the nodes, their places) for every point of the patch.
  template <class Function>
  void for_each_point(const NodePatch& patch, std::span<const Vec3> x_L, const Function& f) const;

  /// v / V - 1; nothing if a point is inside out, or NaN.
  [[nodiscard]] std::optional<double> mean_change(const NodePatch& patch,
                                                  std::span<const Vec3> x_L) const;

  std::vector<Vec3> gradients_;      ///< dN_a/dX.
  std::vector<double> volumes_mm3_;  ///< dV.
  std::vector<ElementGeometry> geometries_;
  std::vector<PatchElement> members_;
  std::vector<std::uint8_t> places_;
  std::vector<std::int32_t> patch_nodes_;
  std::vector<NodePatch> patches_;
  std::vector<std::int32_t> end_of_corners_;   ///< For each element of the mesh, in ...
  std::vector<std::int32_t> patch_of_corner_;  ///< ... this list.
};

}  // namespace lefort::fem
