/// \file
/// Elastic supports of tissue on a rigid bone, as a force term of the solver, with different
/// stiffness along the bone's normal, in compression and in tension, and along its surface.
///
/// A thin elastic layer between two bodies acts as distributed springs (\cite goland1944, \cite
/// klarbring1991). For a node with area A, normal n and rest position X in the frame B of the bone,
/// at the position x_B = X_LB^-1 x:
///
///   s   = x_B - X                                       slip
///   s_t = s - (n . s) n                                 tangential slip
///   e   = n . s, or g(x_B) - g(X) on the surface        opening; g: signed distance of the bone
///   W   = A/2 (k_n e^2 + k_t |s_t|^2)
///   r   = dW/dx, K = d2W/dx2 = A (k_n (m (x) m + e Hess e) + k_t (I - n (x) n)),  m = grad e
///
/// k_n may differ in compression (e < 0) and tension (e > 0); with k_n = 0 in tension the support
/// separates. W, r and K are in the frame of the patient. The stabilized K omits e Hess e.
#pragma once

#include <lefort/contact/rigid_obstacle.h>
#include <lefort/core/types.h>
#include <lefort/fem/assembly/force_term.h>

#include <cstdint>
#include <span>
#include <vector>

namespace lefort::contact {

/// The support of one node.
struct NodalSupport {
  std::int32_t node = 0;
  double area_mm2 = 0.0;               ///< A > 0, of the tissue surface at the node.
  Vec3 normal_B = Vec3::UnitZ();       ///< n, unit length, out of the bone.
  double normal_mpa_per_mm = 0.0;      ///< k_n >= 0 in compression, e < 0.
  double tension_mpa_per_mm = 0.0;     ///< k_n >= 0 in tension, e > 0.
  double tangential_mpa_per_mm = 0.0;  ///< k_t >= 0.
  bool follows_surface = false;        ///< e is measured by the distance query of the bone.
  /// Fraction w of the motion of the bone that the support follows, 0 to 1. Below 1, the support is
  /// at x_0 + w (X_LB X - x_0), where x_0 is the reference position of the node in L, and the
  /// normal keeps its direction in L.
  double motion_fraction = 1.0;
};

/// Motion of supported tissue relative to its bone. Supports with motion_fraction < 1 are left out.
struct SupportStatistics {
  Index nodes = 0;
  double max_slip_mm = 0.0;         ///< Of |s_t|.
  double max_opening_mm = 0.0;      ///< Of e, away from the bone; 0 if there is none.
  double max_compression_mm = 0.0;  ///< Of -e; 0 if there is none.
};

/// Supports of nodes on one bone. An item is a support.
class SupportTerm final : public fem::ForceTerm {
 public:
  /// \param nodes_L   all nodes in the reference configuration [mm].
  /// \param supports  several may have the same node.
  /// \param obstacle  the bone, at its pose in the reference configuration. Its distance query may
  ///   be null if no support follows the surface.
  SupportTerm(std::span<const Vec3> nodes_L, std::vector<NodalSupport> supports,
              RigidObstacle obstacle);

  /// Moves the bone. Not while the term is being evaluated.
  void set_pose(const RigidTransform& X_LB) { obstacle_.X_LB = X_LB; }

  [[nodiscard]] Index item_count() const override { return Index(supports_.size()); }
  [[nodiscard]] std::span<const std::int32_t> nodes(Index item) const override {
    return {&supports_[std::size_t(item)].node, 1};
  }
  /// False if a support follows a surface whose distance query has no exact derivatives.
  [[nodiscard]] bool is_conservative(const fem::DofMap& dofs) const override;
  /// Beyond the range of the query the distance of a support that follows the surface is constant,
  /// so that it exerts no normal force there.
  [[nodiscard]] bool evaluate(Index item, std::span<const Vec3> x_L,
                              fem::LocalEquations& local) const override;

  /// \param x_L  current positions of all nodes [mm].
  [[nodiscard]] SupportStatistics summarize(std::span<const Vec3> x_L) const;

 private:
  /// Motion of a node relative to the bone.
  struct Opening {
    Vec3 tangential_L;  ///< s_t.
    Vec3 normal_L;      ///< n.
    double mm = 0.0;    ///< e.
    Vec3 gradient_L;    ///< m.
    Mat3 hessian_L;     ///< Of e [1/mm].
  };
  [[nodiscard]] Opening opening_of(std::size_t support, const Vec3& x_L) const;

  std::vector<NodalSupport> supports_;
  std::vector<Vec3> rest_B_;         ///< X of each support.
  std::vector<Vec3> rest_L_;         ///< The same point in L, at rest.
  std::vector<double> rest_gap_mm_;  ///< g(X); 0 if the support does not follow the surface.
  RigidObstacle obstacle_;
};

}  // namespace lefort::contact
