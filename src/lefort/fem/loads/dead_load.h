/// \file
/// Dead loads: forces of constant magnitude and direction.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/fem/assembly/force_term.h>
#include <lefort/mesh/volume_mesh.h>

#include <cstdint>
#include <map>
#include <span>
#include <vector>

namespace lefort::fem {

/// A force on one node.
struct NodalForce {
  std::int32_t node = 0;
  Vec3 force_n = Vec3::Zero();
};

/// Work-equivalent nodal forces of a traction that is constant per reference area:
/// f_a = t (integral of N_a dA).
///
/// \param nodes_L       reference positions of all nodes [mm].
/// \param faces         of the boundary of the mesh.
/// \param traction_mpa  t [MPa], in L, on the body.
/// \returns one force per node of `faces`, ascending; or kMeshInvalid if a face names a node twice,
///   or one that does not exist or has no finite position; or kInvalidArgument if t is not finite.
[[nodiscard]] Result<std::vector<NodalForce>> traction_forces(std::span<const Vec3> nodes_L,
                                                              std::span<const mesh::Face> faces,
                                                              const Vec3& traction_mpa);

/// Body forces of regions per reference volume [N/mm^3], in L. Weight is density [t/mm^3] times
/// gravity [mm/s^2].
using RegionBodyForces = std::map<std::int32_t, Vec3>;

/// Work-equivalent nodal forces of body forces: f_a = b (integral of N_a dV).
///
/// \param mesh         accepted by make_element_terms().
/// \param body_forces  b of each region; zero for regions that are not listed.
/// \returns one force per node of the listed regions, ascending; or kElementInverted if one of
///   their elements has no positive reference Jacobian at a quadrature point or a node; or
///   kInvalidArgument if a force is not finite or a region does not occur in `mesh`.
[[nodiscard]] Result<std::vector<NodalForce>> body_forces(const mesh::VolumeMesh& mesh,
                                                          const RegionBodyForces& body_forces);

/// W = -factor (sum over forces of f . u). An item is one of the forces.
class DeadLoad final : public ForceTerm {
 public:
  /// \param nodes_L  reference positions of all nodes [mm].
  /// \param forces   for factor 1; a node may occur more than once. \pre their nodes exist.
  DeadLoad(std::span<const Vec3> nodes_L, std::span<const NodalForce> forces);

  /// Factor of all forces, initially 1. Must not be called while the term is being evaluated.
  void set_factor(double factor) { factor_ = factor; }

  [[nodiscard]] Index item_count() const override { return Index(nodes_.size()); }
  [[nodiscard]] std::span<const std::int32_t> nodes(Index item) const override {
    return {nodes_.data() + item, 1};
  }
  [[nodiscard]] bool evaluate(Index item, std::span<const Vec3> x_L,
                              LocalEquations& local) const override;

 private:
  std::vector<std::int32_t> nodes_;
  std::vector<Vec3> reference_L_;
  std::vector<Vec3> force_n_;
  double factor_ = 1.0;
};

}  // namespace lefort::fem
