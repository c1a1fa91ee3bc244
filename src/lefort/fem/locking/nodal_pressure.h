/// \file
/// Volumetric energy of elements with a continuous pressure (volumetric_integration.h).
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

/// Pressure of the Taylor-Hood pair (\cite taylor1973; \cite boffi2013, chapter 8): continuous
/// in a region, p = sum over corner nodes of N_a p_a, with the functions N_a of the linear shape.
/// The dilatation has the same space, and the integrals of p times dilatation and of U are computed
/// by the nodal quadrature sum over a of V_a f(X_a). It makes their matrix diagonal, so that
/// pressure and dilatation are eliminated node by node and the tangent stays symmetric:
///
///   W  = sum over corner nodes a of V_a U(v_a / V_a),   V_a = integral of N_a dV,
///                                                       v_a = integral of N_a J dV
///   dW = integral of p cof F : dF dV,                   p_a = U'(v_a / V_a)
///
/// The quadrature changes p / kappa, not the integral of p div u, on which the inf-sup condition
/// depends. The change is of second order in the element size, on the boundary of the first, and
/// vanishes as kappa increases. Without it the matrix of the dilatations would have to be inverted,
/// and the tangent would be dense.
///
/// U is here that of the bulk modulus less 2/3 mu, which stays at the points (volumetric_split.h).
///
/// In hex20 the functions at corners of one element only are shared out (lone_corners.h).
///
/// A patch is a corner node with the elements around it that belong to one region, have a decoupled
/// law, and are of a shape with averages at corner nodes. An item is a patch. It couples all nodes
/// of its elements; if these are more than kMaxLocalNodes, the elements are divided between several
/// patches, between which the pressure is discontinuous.
class NodalPressure final : public ForceTerm {
 public:
  /// \param mesh       accepted by make_element_terms(); not referred to afterwards.
  /// \param materials  accepted by make_element_terms(); not referred to afterwards.
  /// \returns the term, or null if no element has a nodal pressure.
  [[nodiscard]] static std::unique_ptr<NodalPressure> build(const mesh::VolumeMesh& mesh,
                                                            const RegionMaterials& materials);

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

  /// \param number    of the element, through the blocks.
  /// \param of_items  the state of each item.
  /// \returns the mean over the element; zero if it has no nodal pressure.
  [[nodiscard]] State mean_of(Index number, std::span<const State> of_items) const;

 private:
  /// Counts and offsets of one element.
  struct ElementGeometry {
    std::int32_t points = 0;
    std::int32_t nodes = 0;
    std::int32_t corners = 0;
    Index first_gradient = 0;  ///< In gradients_: for each point, for each node.
    Index first_weight = 0;    ///< In weights_mm3_: for each point, for each corner.
  };

  /// One element of a patch.
  struct PatchElement {
    std::int32_t element = 0;
    /// In local_nodes_: for each node of the element, its local number in the patch.
    std::int32_t first_local = 0;
    std::int32_t corner = 0;  ///< The corner of the element at the center of the patch.
  };

  struct NodePatch {
    Volumetric volume;
    double volume_mm3 = 0.0;  ///< V_a.
    PatchRange nodes;         ///< In patch_nodes_.
    std::int32_t first_element = 0;
    std::int32_t element_count = 0;
  };

  class Builder;

  NodalPressure() = default;

  /// Calls f(F, N_a dV, gradients dN/dX, local node numbers) for every point of the patch.
  template <class Function>
  void for_each_point(const NodePatch& patch, std::span<const Vec3> x_L, const Function& f) const;

  [[nodiscard]] double weight_mm3(const ElementGeometry& element, std::int32_t point,
                                  std::int32_t corner) const {
    return weights_mm3_[std::size_t(element.first_weight + Index(point) * element.corners +
                                    corner)];
  }

  /// \returns v_a / V_a - 1, or nothing if J <= 0 at a point, or NaN.
  [[nodiscard]] std::optional<double> mean_change(const NodePatch& patch,
                                                  std::span<const Vec3> x_L) const;

  std::vector<Vec3> gradients_;      ///< dN_a/dX.
  std::vector<double> weights_mm3_;  ///< N_a dV of the corners.
  std::vector<ElementGeometry> geometries_;
  std::vector<PatchElement> patch_elements_;
  std::vector<std::uint8_t> local_nodes_;
  std::vector<std::int32_t> patch_nodes_;
  std::vector<NodePatch> patches_;
  std::vector<std::int32_t> end_of_corners_;  ///< Of each element of the mesh, in patch_of_corner_.
  std::vector<std::int32_t> patch_of_corner_;  ///< Item; -1 if the corner has no pressure.
  /// Integral of the pressure function of the corner over the element, over its volume.
  std::vector<double> fraction_of_corner_;
};

}  // namespace lefort::fem
