/// \file
/// Frictionless contact of deformable tissue with one rigid bone, as a force term of the solver.
///
/// The contact potential (penalty.h) is integrated over the faces of the tissue. With the nodal
/// positions x_a, the quadrature points q_n = sum_a N_a(n) x_a, the reference areas A_n, and the
/// signed distance g of the bone:
///
///   g_n   = g(q_n)                     gap; negative inside the bone
///   d_n   = g_0n - g_n                 penetration increase; g_0n: rest gap (rest_gap.h)
///
///   W     = sum_n A_n phi(d_n)
///   r_a   = dW / dx_a       = - sum_n A_n N_a p(d_n) grad g
///   K_ab  = d2W / dx_a dx_b =   sum_n A_n N_a N_b (p'(d_n) grad g (x) grad g - p(d_n) Hess g)
///
/// where the sums of r and K are over the points with d_n > 0.
#pragma once

#include <lefort/contact/contact_clearance.h>
#include <lefort/contact/contact_statistics.h>
#include <lefort/contact/contact_surface.h>
#include <lefort/contact/dense_faces.h>
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

/// Faces of the inner surface of the tissue, of any shape, in contact with one bone. The term has
/// no history: energy and forces are functions of the positions of the nodes and of the pose.
class ContactTerm final : public fem::ForceTerm {
 public:
  struct Options {
    std::string name = "the bone";  ///< Of the obstacle, for messages.
    PressureLaw law;
    /// Contact snap distance: a point whose gap in the reference configuration is at most this in
    /// magnitude touches the bone there; >= 0, less than the range of the distance query.
    double contact_snap_mm = 0.0;
  };

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

  /// Notes which faces are far from the bone. While they have moved little since, evaluate() skips
  /// them. Does not change any result. Not while the term is being evaluated.
  /// \param x_L  current positions of all nodes [mm]; the bone is at its present pose.
  void note_clearances(std::span<const Vec3> x_L);

  [[nodiscard]] Index item_count() const override { return Index(surface_.patches().size()); }
  [[nodiscard]] std::span<const std::int32_t> nodes(Index item) const override {
    return surface_.patch(std::size_t(item)).span();
  }
  /// A potential exists only if the derivatives of the distance query are exact.
  [[nodiscard]] bool is_conservative(const fem::DofMap& /*dofs*/) const override {
    return obstacle_.distance_query_B->has_exact_derivatives();
  }
  /// \returns false if a point lies deeper than the range of the distance query, or if its zone is
  ///   unknown (near a hole of the surface) but was known in the reference configuration.
  [[nodiscard]] bool evaluate(Index item, std::span<const Vec3> x_L,
                              fem::LocalEquations& local) const override;

  [[nodiscard]] std::string inadmissible_cause() const override;

  /// \param from_X_LB  pose of the bone in the last equilibrium.
  /// \param from_L     positions of all nodes in the last equilibrium [mm].
  /// \param to_L       positions of all nodes in the present one [mm].
  /// \returns why the present equilibrium is rejected: more than 2 % of the tissue in the bone has
  ///   passed through thin bone (step_bound.h); nothing otherwise. find_passage() (bone_passage.h)
  ///   is for long increments, in which a bone can pass a face without touching it in the end.
  [[nodiscard]] std::optional<std::string> rejection_reason(const RigidTransform& from_X_LB,
                                                            std::span<const Vec3> from_L,
                                                            std::span<const Vec3> to_L) const;

  /// \returns the max penetration of the points into the bone in the reference configuration [mm];
  ///   0 if none.
  [[nodiscard]] double rest_penetration_mm() const { return rest_penetration_mm_; }

  /// Forces are those of the quadrature points. Depths are those of dense samples of the faces
  /// (dense_faces.h) where the penetration increase is positive.
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
    Gap gap;
  };

  /// Rest gaps of a sample of a face, to the obstacle and to the bone itself.
  struct RestGaps {
    double obstacle_mm = 0.0, bone_mm = 0.0;
  };

  /// Calls f(const PointGap&) for every point of a patch.
  /// \param x_L  current positions of all nodes [mm].
  template <class Function>
  void for_each_point(std::size_t patch, std::span<const Vec3> x_L, const Function& f) const;

  [[nodiscard]] RestGaps rest_gaps(const Vec3& p_L, const Gap& gap,
                                   std::span<const RigidObstacle> other_obstacles) const;
  void find_rest_gaps(std::span<const Vec3> nodes_L,
                      std::span<const RigidObstacle> other_obstacles);
  void find_dense_rest_gaps(std::span<const Vec3> nodes_L,
                            std::span<const RigidObstacle> other_obstacles);
  /// \returns the fraction of the tissue in the bone whose points passed through thin bone.
  [[nodiscard]] double passed_fraction(const RigidTransform& from_X_LB,
                                       std::span<const Vec3> from_L,
                                       std::span<const Vec3> to_L) const;
  /// \returns false if no sample of the face can be in contact.
  [[nodiscard]] bool may_touch(const DenseFace& face, std::span<const RestGaps> rest) const;
  [[nodiscard]] PointContact contact_at(const PointGap& at) const;
  [[nodiscard]] std::vector<DepthSample> depths_of_face(std::size_t face,
                                                        std::span<const Vec3> x_L) const;

  Options options_;
  RigidObstacle obstacle_;
  std::vector<mesh::Face> faces_;
  ContactSurface surface_;            ///< One patch per face.
  std::vector<double> rest_gaps_mm_;  ///< g_0 of each point.
  /// Of each point, in the reference configuration: the distance is known, or the point is outside.
  std::vector<std::uint8_t> has_rest_gap_;
  std::vector<std::vector<RestGaps>> dense_rest_gaps_;  ///< Of the samples of each face.
  double rest_penetration_mm_ = 0.0;
  ContactClearance clearance_;
};

}  // namespace lefort::contact
