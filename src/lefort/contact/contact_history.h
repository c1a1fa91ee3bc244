/// \file
/// History variables of the contact points: multiplier, penalty scale and thin-bone constraint of
/// each point, now and in the last accepted state.
#pragma once

#include <lefort/contact/measure_gap.h>
#include <lefort/contact/penalty.h>
#include <lefort/contact/rigid_obstacle.h>
#include <lefort/contact/thin_bone_contact.h>
#include <lefort/core/types.h>

#include <cstddef>
#include <limits>
#include <vector>

namespace lefort::contact {

/// Accepted state of all points: what a run must store to be resumed with the same results.
struct ContactCheckpoint {
  struct TangentPlane {
    Vec3 foot_B = Vec3::Zero();         ///< ContactReference::foot_B.
    Vec3 normal_B = Vec3::Zero();       ///< ContactReference::normal_B.
    bool is_plane_constrained = false;  ///< The plane is the contact constraint.
  };
  std::vector<double> multipliers_mpa;       ///< One per point.
  std::vector<double> penalty_scales;        ///< One per point.
  std::vector<TangentPlane> tangent_planes;  ///< One per point.
  double tunneled_area_mm2 = 0.0;            ///< Of all increments so far.
};

/// Points are numbered as in ContactSurface. Functions of one point change that point alone, so
/// that different points may be changed by different threads.
class ContactHistory {
 public:
  /// \param points                of all patches.
  /// \param uses_tangent_planes   whether points in thin bone may be constrained by a plane.
  ContactHistory(std::size_t points, bool uses_tangent_planes)
      : points_(points), uses_tangent_planes_(uses_tangent_planes) {}

  [[nodiscard]] bool uses_tangent_planes() const { return uses_tangent_planes_; }

  /// \param stiffness_mpa_per_mm  k_c.
  /// \returns the present multiplier and the stiffness k_c times the present penalty scale.
  [[nodiscard]] PenaltyParameters penalty(std::size_t point, double stiffness_mpa_per_mm) const {
    const State& now = points_[point].now;
    return {now.penalty_scale * stiffness_mpa_per_mm, now.multiplier_mpa};
  }

  /// \returns the gap that the contact force acts on: to the tangent plane if that is the
  ///   constraint of the point, else `measured`.
  [[nodiscard]] Gap acting_gap(std::size_t point, const RigidObstacle& obstacle, const Vec3& p_L,
                               const Gap& measured) const {
    return points_[point].now.is_plane_constrained
               ? gap_to_tangent_plane(obstacle, p_L, points_[point].reference)
               : measured;
  }

  /// \returns whether the zone of the point was known in the last accepted state.
  [[nodiscard]] bool is_side_known(std::size_t point) const {
    return points_[point].reference.is_side_known;
  }

  /// \returns whether the point has neither a multiplier nor a tangent plane, so that only a
  ///   penetration increase can load it.
  [[nodiscard]] bool is_free(std::size_t point) const {
    const State& now = points_[point].now;
    return now.multiplier_mpa == 0.0 && !now.is_plane_constrained;
  }

  /// \returns whether the point has tunneled since the last accepted state.
  [[nodiscard]] bool has_tunneled(std::size_t point, const RigidObstacle& obstacle,
                                  const Gap& measured) const;

  /// Sets the contact reference of a point in the reference configuration.
  void set_reference(std::size_t point, const ContactReference& reference) {
    points_[point].reference = reference;
  }

  /// Accepts the present state of a point. The contact reference is updated, except where a
  /// tangent plane is the constraint or, if planes are used, the medial surface has been crossed.
  /// \returns whether the point has tunneled.
  bool commit(std::size_t point, const RigidObstacle& obstacle, const Vec3& p_L,
              const Gap& measured);

  /// Makes the tangent plane the constraint of a point that has crossed the medial surface.
  /// \returns whether this call has made it the constraint.
  bool activate_tangent_plane(std::size_t point, const RigidObstacle& obstacle, const Vec3& p_L,
                              const Gap& measured);

  /// Update of Hestenes and Powell, with adaptive penalty (\cite bertsekas1982, section 2.2):
  ///
  ///   lambda <- p;   s <- beta s  if d > tolerance and d > gamma d_previous
  ///
  /// with the penalty scale s and the depth d_previous at the last update since begin_step(); the
  /// first update does not raise s. beta, gamma and a bound of s are constants of the .cpp file.
  /// For a point without pressure lambda becomes 0 and s becomes 1.
  /// \param pressure_mpa  p at the converged state, >= 0.
  /// \param depth_mm      d at the converged state.
  /// \param tolerance_mm  penetration tolerance; 0 if there is none.
  /// \returns whether the point has a multiplier now.
  bool update_multiplier(std::size_t point, double pressure_mpa, double depth_mm,
                         double tolerance_mm);

  /// Returns all points to the last accepted state.
  void rollback();

  /// Starts an increment from the last accepted state. Tangent planes of points that had returned
  /// (thin_bone_contact.h) in that state are released.
  void begin_step();

  /// Area that has tunneled in all accepted increments [mm^2].
  [[nodiscard]] double tunneled_area_mm2() const { return tunneled_area_mm2_; }
  void add_tunneled_area_mm2(double area_mm2) { tunneled_area_mm2_ += area_mm2; }
  void set_tunneled_area_mm2(double area_mm2) { tunneled_area_mm2_ = area_mm2; }

  [[nodiscard]] ContactCheckpoint checkpoint() const;

  /// Sets multipliers, penalty scales and planes. Every point must then be committed.
  /// \pre one entry per point in each list.
  void restore(const ContactCheckpoint& checkpoint);

 private:
  /// What the contact force of a point depends on, besides its position.
  struct State {
    double multiplier_mpa = 0.0;
    bool is_plane_constrained = false;  ///< By the tangent plane of the contact reference.
    double penalty_scale = 1.0;
    /// d at the last multiplier update since begin_step(); infinite if there was none.
    double previous_depth_mm = std::numeric_limits<double>::infinity();
  };
  struct Point {
    State now = {};
    State committed = {};
    ContactReference reference = {};
    bool has_returned = false;            ///< In the last accepted state; see has_returned().
    bool crossed_medial_surface = false;  ///< In the last accepted state.
  };

  std::vector<Point> points_;
  bool uses_tangent_planes_;
  double tunneled_area_mm2_ = 0.0;
};

}  // namespace lefort::contact
