/// \file
/// The shear part of tet4 and wedge6, taken at means of F over neighbors
/// (volumetric_integration.h).
#pragma once

#include <lefort/core/types.h>
#include <lefort/fem/assembly/force_term.h>
#include <lefort/fem/locking/node_list_builder.h>
#include <lefort/fem/materials/material.h>
#include <lefort/mesh/volume_mesh.h>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace lefort::fem {

/// W = (1 - kElementStabilizationFraction) * sum over groups of V shear(F),
///     V = sum of V_s,   F = (sum of F_s V_s) / V ,
///
/// the sums running over the sides s (smoothing_domains.h) that lie together, of elements that are
/// of one region and have a law in split form: around an edge of tet4, and on an upright face of
/// wedge6, near its lower or its upper triangle. An item is a group: it couples all nodes of its
/// elements. Where that would be more than kMaxLocalNodes, they are shared out over several items.
class SmoothedStrainTerm final : public ForceTerm {
 public:
  /// \param mesh, materials  accepted by make_element_terms(); the term does not refer to them any
  ///   more.
  /// \returns nothing if there is no such element.
  [[nodiscard]] static std::unique_ptr<SmoothedStrainTerm> build(const mesh::VolumeMesh& mesh,
                                                                 const RegionMaterials& materials);

  [[nodiscard]] Index item_count() const override { return Index(groups_.size()); }
  [[nodiscard]] std::span<const std::int32_t> nodes(Index item) const override;
  [[nodiscard]] bool evaluate(Index item, std::span<const Vec3> x_L,
                              LocalEquations& local) const override;

  /// What is known of an item. NaN where it is inside out.
  struct State {
    Mat3 cauchy_mpa = Mat3::Zero();   ///< Of the shear part.
    double energy_density_mpa = 0.0;  ///< Likewise, per reference volume.
  };

  /// \param x_L  current positions of all nodes [mm].
  [[nodiscard]] State state(Index item, std::span<const Vec3> x_L) const;

  /// One side of an element.
  struct ElementDomain {
    std::int32_t item = 0;
    double fraction = 0.0;  ///< Of the element's volume.
  };

  /// The sides of element `number` (through the blocks); empty if it has none.
  [[nodiscard]] std::span<const ElementDomain> domains_of(Index number) const;

 private:
  struct Group {
    double volume_mm3 = 0.0;
    PatchRange nodes;  ///< In nodes_ and gradients_.
    std::int32_t material = 0;
  };
  class Builder;

  SmoothedStrainTerm() = default;

  /// The mean F, x_L being the positions of the group's nodes.
  [[nodiscard]] Mat3 mean_gradient(const Group& group, std::span<const Vec3> x_L) const;

  std::vector<std::int32_t> nodes_;
  std::vector<Vec3> gradients_;  ///< F = sum of x (x) gradient.
  std::vector<Group> groups_;
  std::vector<Material> materials_;
  std::vector<std::int32_t> end_of_domains_;  ///< For each element of the mesh, in ...
  std::vector<ElementDomain> domains_;        ///< ... this list.
};

}  // namespace lefort::fem
