/// \file
/// Strain energy of tet4 and wedge6 at averages of F over smoothing domains
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

/// Smoothed finite elements (\cite liu2009):
///
///   W = (1 - kElementStabilizationFraction) sum over groups of V Psi(F),
///   V = sum over s of V_s,   F = (sum over s of V_s F_s) / V
///
/// Psi is the law without the volumetric part of AveragedNodalPressure. A group consists of the
/// smoothing domains s (smoothing_domains.h) around one edge of tet4, or on one quadrilateral face
/// of wedge6 near its lower or upper triangle, of elements of one region with a decoupled law. An
/// item is a group. It couples all nodes of its elements; if these are more than kMaxLocalNodes,
/// the domains are divided between several groups. (The literature and docs/theory/locking.md call
/// the whole group a smoothing domain.)
class SmoothedStrainTerm final : public ForceTerm {
 public:
  /// \param mesh       accepted by make_element_terms(); not referred to afterwards.
  /// \param materials  accepted by make_element_terms(); not referred to afterwards.
  /// \returns the term, or null if no element has smoothing domains.
  [[nodiscard]] static std::unique_ptr<SmoothedStrainTerm> build(const mesh::VolumeMesh& mesh,
                                                                 const RegionMaterials& materials);

  [[nodiscard]] Index item_count() const override { return Index(groups_.size()); }
  [[nodiscard]] std::span<const std::int32_t> nodes(Index item) const override;
  [[nodiscard]] bool evaluate(Index item, std::span<const Vec3> x_L,
                              LocalEquations& local) const override;

  /// Stress and energy of one group, of the law Psi above; NaN if its J <= 0.
  struct State {
    Mat3 cauchy_mpa = Mat3::Zero();   ///< Tension positive.
    double energy_density_mpa = 0.0;  ///< Per reference volume.
  };

  /// \param item  number of the group.
  /// \param x_L   current positions of all nodes [mm].
  [[nodiscard]] State state(Index item, std::span<const Vec3> x_L) const;

  /// One smoothing domain of an element.
  struct ElementDomain {
    std::int32_t item = 0;  ///< Its group.
    double fraction = 0.0;  ///< Of the volume of the element.
  };

  /// \param number  of the element, through the blocks.
  /// \returns its smoothing domains; empty if it has none.
  [[nodiscard]] std::span<const ElementDomain> domains_of(Index number) const;

 private:
  struct Group {
    double volume_mm3 = 0.0;
    PatchRange nodes;  ///< In nodes_ and gradients_.
    std::int32_t material = 0;
  };
  class Builder;

  SmoothedStrainTerm() = default;

  /// \param x_L  positions of the nodes of the group.
  /// \returns the average F.
  [[nodiscard]] Mat3 mean_gradient(const Group& group, std::span<const Vec3> x_L) const;

  std::vector<std::int32_t> nodes_;
  std::vector<Vec3> gradients_;  ///< F = sum over nodes of x (x) gradient.
  std::vector<Group> groups_;
  std::vector<Material> materials_;
  std::vector<std::int32_t> end_of_domains_;  ///< Of each element of the mesh, in domains_.
  std::vector<ElementDomain> domains_;        ///< Of all elements.
};

}  // namespace lefort::fem
