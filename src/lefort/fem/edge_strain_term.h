/// \file
/// The shear part of tetrahedra with four nodes, taken at the mean F around each edge
/// (dilatation.h).
#pragma once

#include <lefort/core/types.h>
#include <lefort/fem/force_term.h>
#include <lefort/fem/material.h>
#include <lefort/fem/patch_nodes.h>
#include <lefort/mesh/volume_mesh.h>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace lefort::fem {

/// W = (1 - kRetainedShare) * sum over edges of V shear(F),
///     V = sum of V_e / 6,   F = (sum of F_e V_e / 6) / V ,
///
/// the sums running over the tet4 around the edge that are of one region and have a law in split
/// form. An item is an edge: it couples all nodes of those elements. Where that would be more than
/// kMaxLocalNodes, they are shared out over several items.
class EdgeStrainTerm final : public ForceTerm {
 public:
  /// \param mesh, materials  accepted by make_element_terms(); the term does not refer to them any
  ///   more.
  /// \returns nothing if there is no such element.
  [[nodiscard]] static std::unique_ptr<EdgeStrainTerm> build(const mesh::VolumeMesh& mesh,
                                                             const RegionMaterials& materials);

  [[nodiscard]] Index item_count() const override { return Index(edges_.size()); }
  [[nodiscard]] std::span<const std::int32_t> nodes(Index item) const override;
  [[nodiscard]] bool evaluate(Index item, std::span<const Vec3> x_L,
                              LocalEquations& local) const override;

  /// What is known at an edge. NaN where it is inside out.
  struct State {
    Mat3 cauchy_mpa = Mat3::Zero();   ///< Of the shear part.
    double energy_density_mpa = 0.0;  ///< Likewise, per reference volume.
  };

  /// \param x_L  current positions of all nodes [mm].
  [[nodiscard]] State state(Index item, std::span<const Vec3> x_L) const;

  /// The items of the six edges of element `number` (through the blocks); empty if it has none.
  [[nodiscard]] std::span<const std::int32_t> edges_of(Index number) const;

 private:
  struct Edge {
    double volume_mm3 = 0.0;
    PatchRange nodes;  ///< In nodes_ and gradients_.
    std::int32_t material = 0;
  };
  class Builder;

  EdgeStrainTerm() = default;

  /// The mean F, x_L being the positions of the edge's nodes.
  [[nodiscard]] Mat3 mean_gradient(const Edge& edge, std::span<const Vec3> x_L) const;

  std::vector<std::int32_t> nodes_;
  std::vector<Vec3> gradients_;  ///< F = sum of x (x) gradient.
  std::vector<Edge> edges_;
  std::vector<Material> materials_;
  std::vector<std::int32_t> end_of_sides_;  ///< For each element of the mesh, in ...
  std::vector<std::int32_t> edge_of_side_;  ///< ... this list.
};

}  // namespace lefort::fem
