/// \file
/// Frictionless contact of deformable tissue with rigid bones by weighted gaps, as a force term of
/// the solver. The term has no history: its energy is a function of the positions.
///
/// With the quadrature points q_n = sum_b N_b(n) x_b, their reference areas A_n, the weight
/// functions M_a (weighted_quadrature.h) and the signed distance g to the closest bone, node a has
/// the weighted gap (\cite popp2012, equation (32); \cite hueeber2005)
///
///   A_a   = sum_n A_n M_a(n)
///   g_a   = sum_n A_n M_a(n) (g(q_n) - g_0n) / A_a - g_0a    g_0n: rest gap
///
/// where the offset g_0a <= 0 makes g_a >= 0 in the reference configuration.
///
/// The conditions g_a >= 0, p_a >= 0, p_a g_a = 0 are regularized (Moreau-Yosida, \cite ito2003):
///
///   p_a   = 2 k max(-g_a, 0)                                 contact pressure
///   W     = sum_a A_a k max(-g_a, 0)^2
///   r_b   = - sum_a p_a sum_n A_n M_a N_b grad g
///   K_bc  = sum_a [ 2 k / A_a G_ab G_ac^T - p_a sum_n A_n M_a N_b N_c Hess g ]
///   G_ab  = sum_n A_n M_a N_b grad g
///
/// so that Newton's method is the primal-dual active set strategy. One condition for each
/// quadrature point would over-constrain the faces; one for each node does not.
///
/// A weighted gap is a mean, and lets sharp bone pass between the nodes. Each sharp point v of a
/// bone (bone_points.h) therefore has a condition of its own. D > 0 is its depth behind the tissue
/// faces (point_in_patch.h), D_0 that in the reference configuration, h the element size, and s the
/// fade at the border of the contact faces (point_in_patch.h). The area A_v = h^2 / 4 gives a tip a
/// quarter of the force that a node patch of area h^2 has at the same depth:
///
///   W    += sum_v s A_v k max(D - D_0, 0)^2
///
/// An item is a node patch. It has the part of the energy of v given by the hat function of its
/// node at the closest point; these functions sum to one.
#pragma once

#include <lefort/contact/bone_points.h>
#include <lefort/contact/contact_statistics.h>
#include <lefort/contact/measure_gap.h>
#include <lefort/contact/node_patches.h>
#include <lefort/contact/point_candidates.h>
#include <lefort/contact/rigid_obstacle.h>
#include <lefort/core/types.h>
#include <lefort/fem/assembly/force_term.h>
#include <lefort/mesh/volume_mesh.h>

#include <span>
#include <string>
#include <utility>
#include <vector>

namespace lefort::contact {

/// Default of the penetration increase that a contact pressure of 4 E leaves [mm].
inline constexpr double kWeightedTolerance_mm = 0.01;

/// \param young_mpa     E of the tissue, > 0.
/// \param tolerance_mm  depth that a pressure of 4 E leaves, > 0. Such a nominal stress compresses
///   incompressible neo-Hookean tissue with free sides to less than a third of its height.
/// \returns k: p = 2 k d, so that k = 2 E / tolerance.
[[nodiscard]] constexpr double weighted_stiffness_mpa_per_mm(double young_mpa,
                                                             double tolerance_mm) {
  return 2.0 * young_mpa / tolerance_mm;
}

/// For each node patch, an estimate of its contact pressure [MPa]. In a patch with a positive
/// estimate the penalty acts for both signs of the weighted gap. Empty: contact is unilateral.
using ActiveSet = std::vector<double>;

/// \returns whether the same patches are active.
[[nodiscard]] bool same_active_patches(const ActiveSet& a, const ActiveSet& b);

class WeightedContactTerm final : public fem::ForceTerm {
 public:
  struct Options {
    double stiffness_mpa_per_mm = 0.0;  ///< k > 0; see weighted_stiffness_mpa_per_mm().
    /// Contact snap distance, as in ContactTerm::Options.
    double contact_snap_mm = 0.0;
    /// Whether sharp points have conditions of their own. The tissue mesh must then resolve the
    /// bone except for its edges and tips: more points than nodes over-constrain the faces.
    bool has_sharp_points = true;
  };

  /// \param nodes_L  all nodes in the reference configuration [mm].
  /// \param faces    counter-clockwise seen from outside the tissue.
  /// \param bones    at their poses in the reference configuration; at least one. Their sharp
  ///   points are those of DistanceQuery::surface_B(); without a surface there are none.
  WeightedContactTerm(std::span<const Vec3> nodes_L, std::vector<mesh::Face> faces,
                      std::vector<RigidObstacle> bones, const Options& options);

  /// Moves a bone. Not while the term is being evaluated.
  void set_pose(std::size_t bone, const RigidTransform& X_LB) { obstacles_[bone].X_LB = X_LB; }

  /// Lets the penalty act in the patches of a set for both signs of the weighted gap, and not at
  /// all in the others; used by solve_active_set(). In the Hess g term of the stiffness, p_a is
  /// then the estimated pressure of the set: 2 k times the present depth would be large and wrong
  /// until the step has closed the gap. Sharp points are not affected. Not while the term is being
  /// evaluated.
  /// \param active  one entry per node patch, or empty: unilateral contact.
  void set_active(ActiveSet active) { active_ = std::move(active); }

  /// Notes which patches are far from the bones, and which sharp points are near a patch. While
  /// patches and bones have moved little since, evaluate() skips the far patches and all other
  /// sharp points. Does not change any result. Not while the term is being evaluated.
  /// \param x_L  current positions of all nodes [mm]; the bones are at their present poses.
  void note_clearances(std::span<const Vec3> x_L);

  /// \param x_L  current positions of all nodes [mm].
  /// \returns the contact pressures.
  [[nodiscard]] ActiveSet active_set(std::span<const Vec3> x_L) const;

  /// \param active  the set of a Newton step.
  /// \param from_L  positions of all nodes before the step [mm].
  /// \param to_L    positions after the fraction `length` of it [mm].
  /// \param length  fraction of the step that was done, in (0, 1].
  /// \returns the active nodes whose pressure is positive in the linear model of the whole step,
  ///   and the inactive nodes whose gap is negative at `to_L`.
  [[nodiscard]] ActiveSet updated_active_set(const ActiveSet& active, std::span<const Vec3> from_L,
                                             std::span<const Vec3> to_L, double length) const;

  [[nodiscard]] Index item_count() const override { return Index(patches_.size()); }
  [[nodiscard]] std::span<const std::int32_t> nodes(Index item) const override {
    return patches_[std::size_t(item)].nodes;
  }
  [[nodiscard]] bool is_conservative(const fem::DofMap& /*dofs*/) const override;
  [[nodiscard]] bool evaluate(Index item, std::span<const Vec3> x_L,
                              fem::LocalEquations& local) const override;
  [[nodiscard]] std::string inadmissible_cause() const override;

  /// \param x_L   current positions of all nodes [mm].
  /// \param dx_L  their step [mm].
  /// \returns the largest fraction of the step, in (0, 1], by which no node and no quadrature point
  ///   passes the medial surface of a bone (step_bound.h).
  [[nodiscard]] double max_step_length(std::span<const Vec3> x_L, std::span<const Vec3> dx_L) const;

  /// As max_step_length(), for a motion of tissue and bones from an earlier state to `to_L` and the
  /// present poses.
  /// \param from_L     earlier positions of all nodes [mm].
  /// \param from_X_LB  earlier pose of each bone.
  /// \param to_L       positions of all nodes [mm].
  [[nodiscard]] double max_motion(std::span<const Vec3> from_L,
                                  std::span<const RigidTransform> from_X_LB,
                                  std::span<const Vec3> to_L) const;

  /// Changes the end of a motion that max_motion() does not allow: the nodes of patches through
  /// which a bone would pass move with this bone instead. This is repeated until no bone passes
  /// through a patch, at most 20 times.
  /// \param from_L     earlier positions of all nodes [mm].
  /// \param from_X_LB  earlier pose of each bone.
  /// \param to_L       positions of all nodes [mm].
  /// \returns the changed positions; max_motion() may still not allow them.
  [[nodiscard]] std::vector<Vec3> moved_with_bones(std::span<const Vec3> from_L,
                                                   std::span<const RigidTransform> from_X_LB,
                                                   std::vector<Vec3> to_L) const;

  /// \param x_L  current positions of all nodes [mm].
  /// \returns one entry per bone; forces are those on the tissue. Points, area and depths are those
  ///   of dense samples of the faces; the max depths include all vertices and sharp points of the
  ///   bones behind the faces.
  [[nodiscard]] std::vector<ContactStatistics> summarize(std::span<const Vec3> x_L) const;

  /// \param x_L  current positions of all nodes [mm].
  /// \returns for each bone, one entry per node of the faces, ascending; a node has the pressure
  ///   and depth of its condition at the closest bone, and 0 at the others.
  [[nodiscard]] std::vector<std::vector<NodalContact>> at_nodes_by_bone(
      std::span<const Vec3> x_L) const;

  /// \returns the max penetration of the quadrature points in the reference configuration [mm].
  [[nodiscard]] double rest_penetration_mm() const;

 private:
  struct PatchGap;
  [[nodiscard]] bool measure(const NodePatch& patch, std::span<const Vec3> x_L,
                             fem::LocalEquations* local, PatchGap& gap) const;

  /// Bone that would pass through a point of a patch, and the fraction of the motion before that.
  struct Passage {
    double fraction = 1.0;
    std::size_t bone = 0;
  };
  [[nodiscard]] std::vector<Passage> passages(std::span<const Vec3> from_L,
                                              std::span<const RigidTransform> from_X_LB,
                                              std::span<const Vec3> to_L) const;

  /// Positions of the node of a patch, and of the quadrature points of the faces of which it is the
  /// first node.
  [[nodiscard]] std::vector<Vec3> own_points(const NodePatch& patch,
                                             std::span<const Vec3> x_L) const;
  /// Points of one bone, with their depths D_0 in the reference configuration. D_0 is infinite for
  /// points deeper than max_depth_mm_ there, up to twice as deep: parts of the bone that the tissue
  /// mesh does not resolve.
  struct PointsWithRest {
    BonePoints points;
    std::vector<double> rest_depths_mm;
  };
  /// Calls f(bone, point, PointDepth) for every point that is deeper behind the faces of a patch
  /// than in the reference configuration.
  template <class Function>
  void for_each_point_behind(const std::vector<PointsWithRest>& points, std::size_t patch,
                             std::span<const Vec3> x_L, bool wants_hessian, const Function& f,
                             double max_depth_factor = 1.0) const;
  /// Sets PointsWithRest::rest_depths_mm.
  void find_rest_depths(std::vector<PointsWithRest>& points, std::span<const Vec3> nodes_L) const;
  void find_bone_points(std::span<const Vec3> nodes_L);
  /// \returns a lower bound of g_a, from the last note_clearances() [mm].
  [[nodiscard]] double min_gap_mm(std::size_t patch, std::span<const Vec3> x_L) const;
  [[nodiscard]] bool is_clear(std::size_t patch, std::span<const Vec3> x_L) const;
  void add_faces(std::span<const Vec3> x_L, std::vector<ContactStatisticsSum>& sums) const;
  void add_sharp_points(std::size_t patch, std::span<const Vec3> x_L,
                        fem::LocalEquations& local) const;
  [[nodiscard]] double point_area_mm2() const { return 0.25 * element_size_mm_ * element_size_mm_; }

  std::vector<RigidObstacle> obstacles_;
  Options options_;
  NodePatches patches_;
  ActiveSet active_;
  std::vector<double> rest_gaps_mm_;  ///< g_0 of each quadrature point.
  /// Of each patch: g_a in the reference configuration without this offset, if negative, else 0. It
  /// can be negative, because weight functions are partly negative.
  std::vector<double> rest_offsets_mm_;
  /// Of each patch: depth up to which a point behind it is in contact, half of its radius. The
  /// radius is the largest distance of its node from another node of the patch.
  std::vector<double> max_depth_mm_;
  double element_size_mm_ = 0.0;  ///< h: mean over the patches of their radius (max_depth_mm_).
  std::vector<PointsWithRest> sharp_points_, vertices_;  ///< Of each bone.
  std::vector<mesh::Face> faces_;
  std::vector<double> face_areas_mm2_;           ///< In the reference configuration.
  std::vector<double> dense_rest_gaps_mm_;       ///< g_0 of the dense samples of all faces.
  std::vector<double> dense_bone_rest_gaps_mm_;  ///< The same to the bone itself.
  std::vector<double> gap_bounds_;  ///< Of each patch: bound of |change of g_a| over |motion|.

  /// \returns how far a node of a patch has moved relative to a bone since note_clearances() [mm];
  ///   infinite if it has not been called.
  [[nodiscard]] double moved_since_note_mm(std::size_t bone, std::size_t patch,
                                           std::span<const Vec3> x_L) const;

  /// The state of the last note_clearances().
  struct Clearances {
    std::vector<Vec3> x_L;
    std::vector<RigidTransform> X_LB;
    std::vector<double> gaps_mm;  ///< g_a.
    PointCandidates points;       ///< Sharp points.
  };
  Clearances clearances_;
};

}  // namespace lefort::contact
