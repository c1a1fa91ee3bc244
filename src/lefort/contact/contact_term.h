/// \file
/// The paper's contact force, equation (3), as a force term of the solver: the contact potential
/// (penalty.h) integrated over the tissue's surface.
#pragma once

#include <lefort/contact/measure_gap.h>
#include <lefort/contact/penalty.h>
#include <lefort/contact/rigid_obstacle.h>
#include <lefort/contact/thin_bone_contact.h>
#include <lefort/core/types.h>
#include <lefort/fem/assembly/force_term.h>
#include <lefort/mesh/volume_mesh.h>

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lefort::contact {

/// Where the potential is integrated.
enum class Integration : std::uint8_t {
  kQuadrature,  ///< At points inside the faces.
  kNodes,       ///< At nodes, each for its share of the faces around it; for comparison.
};

/// As plans and results call it.
[[nodiscard]] constexpr std::string_view name_of(Integration integration) {
  return integration == Integration::kNodes ? "nodes" : "quadrature";
}

/// What contact does at one state.
struct ContactStatistics {
  Index points = 0;       ///< Points of integration in contact.
  Index nodes = 0;        ///< Nodes of faces with such a point.
  double area_mm2 = 0.0;  ///< Of the tissue's surface at rest, in contact.
  /// How deep tissue lies in the bone: minus the gap, at most and on average over that area.
  double max_penetration_mm = 0.0;
  double mean_penetration_mm = 0.0;
  /// How much nearer to the bone tissue lies than at rest: what the contact force acts on.
  double max_depth_from_rest_mm = 0.0;
  double mean_depth_from_rest_mm = 0.0;
  double p99_depth_from_rest_mm = 0.0;  ///< All of that area but 1 % lies no deeper; >= 0.
  Vec3 force_L_n = Vec3::Zero();        ///< On the tissue [N].
  double normal_force_n = 0.0;          ///< Sum of the magnitudes [N].
  /// Of the tissue's surface at rest, what has crept through thin bone since then, but for what
  /// keeps its side; a part counts each time it does.
  double tunnelled_area_mm2 = 0.0;
};

/// What contact with two bones does: sums, maxima, means over both areas. Tissue that touches both
/// counts twice. The P99 is the larger one; that of the area of both is no larger.
[[nodiscard]] ContactStatistics combine(const ContactStatistics& a, const ContactStatistics& b);

/// What contact does at one node of its faces.
struct NodalContact {
  std::int32_t node = 0;
  double pressure_mpa = 0.0;  ///< Mean over the points around it, weighted by the node's share.
  double gap_mm = 0.0;        ///< Plus or minus the band beyond it; NaN where the field is torn.
  /// How much nearer to the bone than at rest the deepest point around it in contact lies; >= 0.
  double depth_mm = 0.0;
};

/// What contact does at one point of integration.
struct TouchedPoint {
  Vec3 x_L = Vec3::Zero();      ///< Where it is now [mm].
  double pressure_mpa = 0.0;    ///< > 0.
  Vec3 force_n = Vec3::Zero();  ///< On the tissue.
};

/// Faces of the tissue's inner surface, of any shape, against one bone.
///
/// Penetration is measured from how the face lay at rest: the mesh meets the bone's surface only
/// within a chord's height, and a patient at rest is in equilibrium. So a point that rests within
/// `capture_mm` of the bone touches it, and a point that the mesh put deeper starts from there.
///
/// In thin bone the nearest surface may be the far one, and the way out leads through the bone. So
/// the term remembers what each point saw of the bone when commit() was last called. Where a
/// depth is asked for, a point that has come past the middle since is held off by that
/// (thin_bone_contact.h) once activate_tangent_planes() was called, and from then on until it sees
/// its side again and begin() is called. In between nothing changes sides, so that there is a
/// potential. The penalty alone is too soft for that: tissue lies in thin bone at most states, and
/// which of it were held off would depend on the increments.
///
/// A point may carry a multiplier, the pressure that it bears without depth (penalty.h). All are
/// zero until update_multipliers() is called.
class ContactTerm final : public fem::ForceTerm {
 public:
  struct Options {
    std::string name = "the bone";      ///< Of the obstacle, for sentences.
    double stiffness_mpa_per_mm = 0.0;  ///< k_c > 0.
    double capture_mm = 0.0;            ///< >= 0, less than the detector's reach.
    Integration integration = Integration::kQuadrature;
    /// How deep the P99 of tissue in contact may lie, > 0 [mm]: multipliers see to it
    /// (solve_augmented_lagrangian.h). Without, the penalty alone holds it off.
    std::optional<double> penetration_tolerance_mm = std::nullopt;
  };

  /// \param nodes_L   all nodes at rest [mm].
  /// \param faces     counter-clockwise seen from outside the tissue.
  /// \param obstacle  the bone, at rest.
  /// \param beside    other bones, at rest. A point that is nearer to one of them rests on that
  ///   one, and touches this bone only where it would enter it: else a bone whose edge lies flush
  ///   with another's would drag along what lies on the other.
  ContactTerm(std::span<const Vec3> nodes_L, std::vector<mesh::Face> faces, RigidObstacle obstacle,
              const Options& options, std::span<const RigidObstacle> other_obstacles = {});

  /// Moves the bone. Not while the term is being evaluated.
  void set_pose(const RigidTransform& X_LB) { obstacle_.X_LB = X_LB; }

  [[nodiscard]] Index item_count() const override { return Index(patches_.size()); }
  [[nodiscard]] std::span<const std::int32_t> nodes(Index item) const override {
    return patches_[std::size_t(item)].span();
  }
  /// Only where the detector's derivatives are exact is there a potential.
  [[nodiscard]] bool is_conservative(const fem::DofMap& /*dofs*/) const override {
    return obstacle_.distance_query_B->has_exact_derivatives();
  }
  /// \returns false where a point lies deeper than the detector reaches, so that it knows no way
  ///   out, or has come to where a hole of the surface hides which side it is on.
  [[nodiscard]] bool evaluate(Index item, std::span<const Vec3> x_L,
                              fem::LocalEquations& local) const override;

  /// Remembers multipliers, sides and what every point sees of the bone at its present pose: where
  /// sides are kept, of one past the middle what it saw before. Adds what has lost its side to
  /// ContactStatistics::tunnelled_area_mm2. To be called at each state that is accepted; not while
  /// the term is being evaluated.
  /// \param x_L  current positions of all nodes [mm].
  void commit(std::span<const Vec3> x_L);

  /// Goes back to what was remembered last.
  void rollback();

  /// The same for another load: points that saw their side again are held off by the nearest
  /// surface anew.
  void begin_step();

  /// If a depth is asked for: from now on points that have come past the middle of the bone since
  /// commit() are held off by what they saw then. Not while the term is being evaluated.
  /// \param x_L  current positions of all nodes [mm].
  /// \returns how many there are that were not before.
  Index activate_tangent_planes(std::span<const Vec3> x_L);

  /// Lets each multiplier bear what the point's pressure is at a converged state, so that the next
  /// one lies less deep (the update of Hestenes and Powell). A point that is pressed no more loses
  /// its multiplier: nothing ever pulls. Where a point lies deeper than the tolerance and half as
  /// deep as the last time, its spring gets stiffer, up to a bound (\cite bertsekas1982, section
  /// 2.2): squeezed tissue is stiffer than its modulus says. It stays so as long as the multiplier:
  /// a softer spring may have no stable balance under that pressure. Not while the term is being
  /// evaluated.
  /// \param x_L  current positions of all nodes [mm].
  void update_multipliers(std::span<const Vec3> x_L);

  [[nodiscard]] std::optional<double> penetration_tolerance_mm() const {
    return penetration_tolerance_mm_;
  }

  /// What a run must keep to go on elsewhere as if it had not stopped.
  struct Checkpoint {
    struct TangentPlane {
      Vec3 foot_B = Vec3::Zero();         ///< As ContactReference::foot_B ...
      Vec3 normal_B = Vec3::Zero();       ///< ... and ContactReference::normal_B.
      bool is_plane_constrained = false;  ///< Holds the point off.
    };
    std::vector<double> multipliers_mpa;       ///< One per point of integration.
    std::vector<double> penalty_scales;        ///< Of their springs, likewise.
    std::vector<TangentPlane> tangent_planes;  ///< Likewise.
    double tunnelled_area_mm2 = 0.0;
  };
  [[nodiscard]] Checkpoint checkpoint() const;

  /// Sets the term to what it was after commit(x_L) at its present pose.
  /// \pre `memory` is of a term made alike.
  void restore(const Checkpoint& checkpoint, std::span<const Vec3> x_L);

  /// Area of the tissue's surface at rest that lies in the bone and has changed sides since
  /// commit() was last called [mm^2].
  [[nodiscard]] double newly_tunnelled_area_mm2(std::span<const Vec3> x_L) const;

  /// Why a converged state is not to be accepted: an obstacle that jumped through the body leaves
  /// it in balance on the wrong side, and a smaller increment would not. Nothing if it is; what
  /// creeps over a thin edge is told, but not refused, since no increment would be small enough.
  /// \param x_L  current positions of all nodes [mm].
  [[nodiscard]] std::optional<std::string> rejection_reason(std::span<const Vec3> x_L) const;

  /// How deep the mesh lies in the bone at rest, at most [mm]; 0 if nowhere.
  [[nodiscard]] double rest_penetration_mm() const;

  /// \param x_L  current positions of all nodes [mm].
  [[nodiscard]] ContactStatistics summarize(std::span<const Vec3> x_L) const;

  /// \param x_L  likewise.
  /// \returns one entry per node of the faces, ascending.
  [[nodiscard]] std::vector<NodalContact> at_nodes(std::span<const Vec3> x_L) const;

  /// \param x_L  likewise.
  /// \returns the points of integration in contact, in the order of the faces.
  [[nodiscard]] std::vector<TouchedPoint> touched_points(std::span<const Vec3> x_L) const;

 private:
  /// What holds a point off.
  struct PointState {
    double multiplier_mpa = 0.0;
    bool is_plane_constrained = false;  ///< By what it saw last, not by the nearest surface.
    double penalty_scale = 1.0;         ///< Of its spring.
    /// When last augmented since begin().
    double depth_mm = std::numeric_limits<double>::infinity();
  };

  /// Where a patch is asked for its gap.
  struct Point {
    double area_mm2 = 0.0;     ///< Of the surface at rest that it stands for.
    double rest_gap_mm = 0.0;  ///< Where penetration starts.
    PointState now = {};
    PointState committed = {};
    ContactReference committed_reference =
        {};                     ///< When last remembered; before it kept its side, if it does.
    bool has_returned = false;  ///< Again, when last remembered.
    bool crossed_medial_surface = false;  ///< Past the middle, when last remembered.
  };

  struct PointGap;

  /// A face, or a node that stands for its share of the faces around it.
  struct Patch {
    std::array<std::int32_t, 8> nodes{};
    std::uint8_t count = 0;
    std::uint8_t rule = 0;        ///< Where in it the points lie.
    std::size_t first_point = 0;  ///< In points_.

    [[nodiscard]] std::span<const std::int32_t> span() const { return {nodes.data(), count}; }
  };

  /// Where a patch was in the bone's frame when last remembered, and how far all of it was from
  /// contact then [mm]: distances change no faster than points move.
  struct Clearance {
    std::array<Vec3, 8> nodes_B;
    double clearance_mm = 0.0;
  };

  void add_faces(std::span<const Vec3> nodes_L, const std::vector<mesh::Face>& faces);
  void add_nodes(std::span<const Vec3> nodes_L, const std::vector<mesh::Face>& faces);

  /// Calls f(where in points_, where in the patch's rule, PointGap) for every point of a patch; x_L
  /// of all nodes.
  template <class Function>
  void for_each_point(const Patch& patch, std::span<const Vec3> x_L, const Function& f) const;

  [[nodiscard]] PenaltyParameters penalty_at(const Point& point) const {
    return {point.now.penalty_scale * stiffness_mpa_per_mm_, point.now.multiplier_mpa};
  }
  [[nodiscard]] bool uses_tangent_planes() const { return penetration_tolerance_mm_.has_value(); }
  [[nodiscard]] Gap acting_gap(const Point& point, const Vec3& p_L, const Gap& measured) const;
  [[nodiscard]] double pressure_at(const Point& point, const Gap& acting) const;
  [[nodiscard]] double rest_gap_mm(const Gap& at_rest, double capture_mm) const;
  [[nodiscard]] bool is_out_of_range(std::size_t patch, std::span<const Vec3> x_L) const;
  [[nodiscard]] bool has_tunnelled(const Point& point, const Gap& measured) const;
  void note_clearances(std::span<const Vec3> x_L);

  std::vector<Patch> patches_;
  std::vector<Point> points_;
  std::vector<Clearance> last_clearance_;  ///< Of each patch.
  double tunnelled_area_mm2_ = 0.0;
  std::string name_;
  RigidObstacle obstacle_;
  double stiffness_mpa_per_mm_;
  std::optional<double> penetration_tolerance_mm_;
};

}  // namespace lefort::contact
