/// \file
/// Frictionless contact of deformable tissue with one rigid bone, as a force term of the solver.
///
/// The contact potential (\cite lefort-paper; penalty.h) is integrated over the faces of the
/// tissue. With the nodal positions x_a, the quadrature points q_n = sum_a N_a(n) x_a, the
/// reference areas A_n, and the signed distance g of the bone:
///
///   g_n   = g(q_n)                                     gap; negative inside the bone
///   d_n   = g_0n - g_n                                 penetration increase; g_0n: rest gap
///   p_n   = max(lambda_n + 2 s_n k_c d_n, 0)           contact pressure
///   phi_n = (p_n^2 - lambda_n^2) / (4 s_n k_c)         potential; s_n k_c d_n^2 if lambda_n = 0
///
///   W     = sum_n A_n phi_n
///   r_a   = dW / dx_a       = - sum_n A_n N_a p_n grad g
///   K_ab  = d2W / dx_a dx_b =   sum_n A_n N_a N_b (2 s_n k_c grad g (x) grad g - p_n Hess g)
///
/// where the sum of K is over the points with p_n > 0 only; lambda_n >= 0 is the multiplier and
/// s_n >= 1 the penalty scale of the point.
#pragma once

#include <lefort/contact/contact_clearance.h>
#include <lefort/contact/contact_history.h>
#include <lefort/contact/contact_statistics.h>
#include <lefort/contact/contact_surface.h>
#include <lefort/contact/measure_gap.h>
#include <lefort/contact/penalty.h>
#include <lefort/contact/rigid_obstacle.h>
#include <lefort/core/types.h>
#include <lefort/fem/assembly/force_term.h>
#include <lefort/mesh/volume_mesh.h>

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lefort::contact {

/// Faces of the inner surface of the tissue, of any shape, in contact with one bone.
///
/// **Rest gap.** Contact depends on the change from a rest gap (rest_gap.h).
///
/// **Thin bone.** The closest surface may lie on the far side of thin bone (thin_bone_contact.h).
/// If a penetration tolerance is set, a point that has crossed the medial surface is constrained by
/// the tangent plane of its contact reference. Planes change between solves only, so that
/// each solve has a potential. Without a tolerance there are no planes: the penalty is so soft that
/// tissue often lies beyond the medial surface, and with planes the result would depend on the
/// increments.
///
/// **States.** Each point has a present and an accepted state (contact_history.h). None of the
/// functions that change them may be called while the term is being evaluated.
///
///     accepted --- begin_step() ---> present --- solve ---> equilibrium
///        ^                            |   ^                  |       |
///        |<------- rollback() --------'   |                  |       | rejection_reason()
///        |<------- commit() ------------- | -----------------'       v
///        |                                |                       rejected
///        '----- update_multipliers(), ----'
///               activate_tangent_planes()
///
/// solve_augmented_lagrangian() is this loop.
class ContactTerm final : public fem::ForceTerm {
 public:
  struct Options {
    std::string name = "the bone";      ///< Of the obstacle, for messages.
    double stiffness_mpa_per_mm = 0.0;  ///< k_c > 0.
    /// Contact snap distance: a point whose gap in the reference configuration is at most this in
    /// magnitude touches the bone there; >= 0, less than the range of the distance query.
    double contact_snap_mm = 0.0;
    Integration integration = Integration::kQuadrature;
    /// Max P99 of the penetration increase, > 0 [mm], reached by multipliers
    /// (solve_augmented_lagrangian.h). Empty: penalty only.
    std::optional<double> penetration_tolerance_mm = std::nullopt;
  };
  using Checkpoint = ContactCheckpoint;

  /// \param nodes_L          all nodes in the reference configuration [mm].
  /// \param faces            counter-clockwise seen from outside the tissue.
  /// \param obstacle         the bone, at its pose in the reference configuration.
  /// \param options          \pre in the ranges above.
  /// \param other_obstacles  other bones, at their poses in the reference configuration. For a
  ///   point closer to one of them than to this bone the snap distance is 0: the edge of this bone
  ///   must not drag tissue that lies on the other.
  ContactTerm(std::span<const Vec3> nodes_L, std::vector<mesh::Face> faces, RigidObstacle obstacle,
              const Options& options, std::span<const RigidObstacle> other_obstacles = {});

  /// Moves the bone. Not while the term is being evaluated.
  /// \param X_LB  pose of the bone in the frame of the patient.
  void set_pose(const RigidTransform& X_LB) { obstacle_.X_LB = X_LB; }

  [[nodiscard]] Index item_count() const override { return Index(surface_.patches().size()); }
  [[nodiscard]] std::span<const std::int32_t> nodes(Index item) const override {
    return surface_.patch(std::size_t(item)).span();
  }
  /// A potential exists only if the derivatives of the distance query are exact.
  [[nodiscard]] bool is_conservative(const fem::DofMap& /*dofs*/) const override {
    return obstacle_.distance_query_B->has_exact_derivatives();
  }
  /// \returns false if a point lies deeper than the range of the distance query, or if its zone is
  ///   unknown (near a hole of the surface) but was known in the last accepted state.
  [[nodiscard]] bool evaluate(Index item, std::span<const Vec3> x_L,
                              fem::LocalEquations& local) const override;

  [[nodiscard]] std::string inadmissible_cause() const override;

  /// Accepts the present state at the present pose and adds the area that has tunneled since the
  /// last accepted state to ContactStatistics::tunneled_area_mm2.
  /// \param x_L  current positions of all nodes [mm].
  void commit(std::span<const Vec3> x_L);

  /// Returns to the last accepted state.
  void rollback();

  /// Starts an increment from the last accepted state; tangent planes of points that had returned
  /// in that state (thin_bone_contact.h) are released.
  void begin_step();

  /// Activates the tangent planes of points that have crossed the medial surface at `x_L`
  /// (has_crossed_medial_surface()). Does nothing without a penetration tolerance.
  /// \param x_L  current positions of all nodes [mm].
  /// \returns the number of newly constrained points.
  Index activate_tangent_planes(std::span<const Vec3> x_L);

  /// Sets each multiplier to the pressure of its point at a converged state, and raises the penalty
  /// scale of points whose depth decreases too slowly (ContactHistory::update_multiplier).
  /// \param x_L  current positions of all nodes [mm].
  void update_multipliers(std::span<const Vec3> x_L);

  /// ContactTerm::Options::penetration_tolerance_mm.
  [[nodiscard]] std::optional<double> penetration_tolerance_mm() const {
    return penetration_tolerance_mm_;
  }

  /// \returns the last accepted state.
  [[nodiscard]] Checkpoint checkpoint() const { return history_.checkpoint(); }

  /// Sets the term to the state it had after commit(x_L) at its present pose.
  /// \param checkpoint  \pre of a term with the same constructor arguments.
  /// \param x_L         current positions of all nodes [mm].
  void restore(const Checkpoint& checkpoint, std::span<const Vec3> x_L);

  /// \param x_L  current positions of all nodes [mm].
  /// \returns the reference area that has tunneled since the last accepted state [mm^2].
  [[nodiscard]] double newly_tunneled_area_mm2(std::span<const Vec3> x_L) const;

  /// If the bone has jumped through the tissue, the tissue is in equilibrium on the wrong side of
  /// the bone. An increment in which too much of the contact area has tunneled is therefore
  /// rejected. Small areas are accepted and reported: they tunnel over thin edges even in the
  /// smallest increments.
  /// \param x_L  current positions of all nodes [mm].
  /// \returns why a converged state is rejected; nothing if it is accepted.
  [[nodiscard]] std::optional<std::string> rejection_reason(std::span<const Vec3> x_L) const;

  /// \returns the max penetration of the points into the bone in the reference configuration [mm];
  ///   0 if none.
  [[nodiscard]] double rest_penetration_mm() const { return rest_penetration_mm_; }

  /// \param x_L  current positions of all nodes [mm].
  [[nodiscard]] ContactStatistics summarize(std::span<const Vec3> x_L) const;

  /// \param x_L  current positions of all nodes [mm].
  /// \returns one entry per node of the faces, ascending.
  [[nodiscard]] std::vector<NodalContact> at_nodes(std::span<const Vec3> x_L) const;

  /// \param x_L  current positions of all nodes [mm].
  /// \returns the quadrature points in contact, in the order of the faces.
  [[nodiscard]] std::vector<ContactPoint> contact_points(std::span<const Vec3> x_L) const;

 private:
  /// A quadrature point at one state.
  struct PointGap {
    std::size_t number = 0;  ///< Among the points of all patches.
    std::span<const double> N;
    Vec3 p_L;
    Gap measured;  ///< To the closest surface.
    Gap acting;    ///< To the constraint: the closest surface or the tangent plane.
  };

  /// Calls f(const PointGap&) for every point of a patch.
  /// \param x_L  current positions of all nodes [mm].
  template <class Function>
  void for_each_point(std::size_t patch, std::span<const Vec3> x_L, const Function& f) const;

  [[nodiscard]] double pressure_at(const PointGap& at) const;
  [[nodiscard]] PointContact contact_at(const PointGap& at) const;
  void note_clearances(std::span<const Vec3> x_L);

  std::string name_;
  RigidObstacle obstacle_;
  double stiffness_mpa_per_mm_;
  std::optional<double> penetration_tolerance_mm_;
  ContactSurface surface_;
  std::vector<double> rest_gaps_mm_;       ///< g_0 of each point.
  std::vector<double> bone_rest_gaps_mm_;  ///< The same to the bone itself.
  double rest_penetration_mm_ = 0.0;
  ContactHistory history_;
  ContactClearance clearance_;
};

}  // namespace lefort::contact
