/// \file
/// Contact of the face by weighted gaps (contact/weighted_contact_term.h).
#pragma once

#include <lefort/contact/solve_active_set.h>
#include <lefort/contact/weighted_contact_term.h>
#include <lefort/core/types.h>
#include <lefort/fem/solve/newton.h>
#include <lefort/mesh/volume_mesh.h>

#include <optional>
#include <span>
#include <vector>

namespace lefort::predict {

/// One term for all segments, and one for stationary bone. A term is missing if tissue cannot touch
/// that bone.
class WeightedContacts {
 public:
  std::optional<contact::WeightedContactTerm> on_segments, on_stationary;

  /// \param tissue    must outlive the object; the faces of its set `contact` touch the segments.
  /// \param segments  at their poses in the reference configuration.
  void add_segments(const mesh::VolumeMesh& tissue, std::vector<contact::RigidObstacle> segments,
                    const contact::WeightedContactTerm::Options& options);
  /// \param faces  that touch stationary bone.
  void add_stationary(const mesh::VolumeMesh& tissue, const std::vector<mesh::Face>& faces,
                      const contact::RigidObstacle& bone,
                      const contact::WeightedContactTerm::Options& options);

  [[nodiscard]] bool any() const { return on_segments || on_stationary; }
  [[nodiscard]] std::vector<const contact::WeightedContactTerm*> terms() const;

  /// \param X_LB  of each segment.
  void set_poses(const std::vector<RigidTransform>& X_LB);

  /// \param u   displacements of all nodes [mm].
  /// \param du  their step [mm].
  /// \returns the max fraction of the step by which no point passes through a bone.
  [[nodiscard]] double max_step_length(const VectorX& u, const VectorX& du) const;

  /// Finds equilibrium by contact::solve_active_set(). If a segment would pass through tissue on
  /// the way from the last equilibrium to the start, that tissue starts with the motion of the
  /// segment. If a bone would still pass through tissue, the outcome is kInadmissibleStart.
  /// \param from_X_LB       poses in the last equilibrium.
  /// \param u_last          displacements in the last equilibrium [mm].
  /// \param X_LB            present poses, which are those of the terms.
  /// \param start           displacements of all nodes [mm].
  /// \param max_iterations  of the unilateral solve.
  /// \param solve           one Newton step or the unilateral solve.
  [[nodiscard]] fem::NewtonOutcome solve(const std::vector<RigidTransform>& from_X_LB,
                                         const VectorX& u_last,
                                         const std::vector<RigidTransform>& X_LB,
                                         const VectorX& start, int max_iterations,
                                         const contact::SolveFrom& solve);

 private:
  /// Whether no bone passes through tissue on the way from the last equilibrium to displacements
  /// `to` and the present poses.
  [[nodiscard]] bool allows_motion(const std::vector<RigidTransform>& from_X_LB,
                                   const std::vector<Vec3>& last_L, const VectorX& to) const;
  /// Displacements `to`, but tissue through which a segment would pass moves with this segment.
  [[nodiscard]] VectorX moved_with_bones(const std::vector<RigidTransform>& from_X_LB,
                                         const std::vector<Vec3>& last_L, const VectorX& to) const;

  const mesh::VolumeMesh* tissue_ = nullptr;
};

}  // namespace lefort::predict
