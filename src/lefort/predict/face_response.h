/// \file
/// A live model of a face: its equilibrium at any poses of the segments, and its derivatives by the
/// numbers of their motions.
///
/// Let r(u, q) = 0 be the equilibrium with the displacements u = (u_f, u_p) of free and prescribed
/// nodes, and q a number of the motion of the segments. Prescribed nodes move with their bone, and
/// supports and obstacles act at its pose (contact/pose_derivative.h). With the exact tangent K,
/// the derivative of the equilibrium is (\cite haug1986, direct differentiation and adjoint)
///
///   K_ff du_f/dq = -(K_fp du_p/dq + dr_f/dq)
///
/// and, for an objective J(u) with K_ff l = dJ/du_f,
///
///   dJ/dq = dJ/du_p . du_p/dq - l . (K_fp du_p/dq + dr_f/dq)
///
/// It exists where no point comes into contact or separates at this pose; elsewhere it is the
/// derivative with the present contact, one of the one-sided derivatives.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/core/types.h>
#include <lefort/geometry/motion_rates.h>
#include <lefort/geometry/rigid_motion.h>
#include <lefort/linear/linear_solver.h>
#include <lefort/predict/face_body.h>
#include <lefort/predict/face_model.h>
#include <lefort/predict/predict_face.h>

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace lefort::predict {

/// An equilibrium of a FaceResponse, from which another can be found. A value.
struct FaceState {
  FaceEquilibrium at;

  /// \returns the displacement of each node [mm].
  [[nodiscard]] std::vector<Vec3> displacement_mm() const;
};

/// Motion of segments by one number: one segment, or several that move together. Segments that are
/// not named do not move.
using PoseRate = std::vector<std::pair<std::size_t, geometry::MotionRate>>;

/// Not thread-safe; several instances of one model may be used at the same time.
class FaceResponse {
 public:
  /// \param model     must outlive the result.
  /// \param names     of its segments, for messages.
  /// \param options   materials, boundary, contact and solver.
  /// \param progress  receives warnings.
  /// \param linear    solver of the equilibrium. With kReusedFactor the result depends, within the
  ///   tolerance, on earlier solves.
  /// \returns the errors of predict_face(), except those of paths.
  [[nodiscard]] static Result<std::unique_ptr<FaceResponse>> create(
      const FaceModel& model, std::vector<std::string> names, const PredictionOptions& options,
      Progress& progress = Progress::none(), const linear::LinearSolverOptions& linear = {});

  /// \returns the state in which no segment has moved.
  [[nodiscard]] FaceState at_rest() const;

  /// Finds the equilibrium at poses. Each segment moves from its pose in `start` to the new one:
  /// its centroid along a straight line, its orientation at a constant rate. This motion is
  /// divided into increments as in predict_face() (load_levels.h); an increment that fails is
  /// halved.
  /// \param X_LB      pose of each segment.
  /// \param start     an equilibrium of this model; with contact, the result may depend on it.
  /// \param progress  may stop the solve.
  /// \returns kNotConverged, kOutOfMemory or kCancelled, as fem::LoadStepper::advance_to();
  ///   kInvalidArgument if a pose is not finite.
  [[nodiscard]] Result<FaceState> solve(const std::vector<RigidTransform>& X_LB,
                                        const FaceState& start,
                                        Progress& progress = Progress::none());

  /// As solve(), but Newton's method begins at a state that is nearer to the poses, in equilibrium
  /// or not. Contact is checked for the motion from `start`, from which the solve is repeated if
  /// this fails.
  /// \param near  a state of this model.
  [[nodiscard]] Result<FaceState> solve_near(const std::vector<RigidTransform>& X_LB,
                                             const FaceState& start, const FaceState& near);

  /// Newton iterations towards the equilibrium at poses, for a face that follows a drag. The result
  /// is a state for solve_near(), and often near the equilibrium, but no result.
  /// \param X_LB        pose of each segment.
  /// \param start       a state of this model.
  /// \param iterations  max number in each increment, >= 1.
  /// \returns the last state, in equilibrium or not; as solve() if there are more than three
  ///   increments, or if no step is acceptable.
  [[nodiscard]] Result<FaceState> approach(const std::vector<RigidTransform>& X_LB,
                                           const FaceState& start, int iterations);

  /// \param state  an equilibrium of this model.
  /// \param rates  one for each number.
  /// \returns the derivatives of the displacements of all nodes, three rows per node, one column
  ///   for each number [mm per unit of the number]; or
  ///   - kNotConverged     the tangent is not positive definite: the equilibrium is not stable;
  ///   - kInvalidArgument  no derivative is computed with weighted gaps or a query without exact
  ///     derivatives (detection bvh);
  ///   - kOutOfMemory.
  [[nodiscard]] Result<Eigen::MatrixXd> sensitivities(const FaceState& state,
                                                      std::span<const PoseRate> rates);

  /// The same by the adjoint method, for one objective J of the displacements.
  /// \param dJ_du  dJ/du at `state`, three per node.
  /// \returns dJ/dq for each number; errors as sensitivities().
  [[nodiscard]] Result<VectorX> gradient(const FaceState& state, const VectorX& dJ_du,
                                         std::span<const PoseRate> rates);

  [[nodiscard]] const FaceModel& model() const { return body_->model(); }
  [[nodiscard]] const PredictionOptions& options() const { return options_; }
  [[nodiscard]] std::size_t segment_count() const { return body_->model().segments.size(); }

  /// Newton iterations of all solves since construction.
  [[nodiscard]] Index newton_iterations() const { return newton_iterations_; }

 private:
  FaceResponse(const PredictionOptions& options, const linear::LinearSolverOptions& linear)
      : options_(options), linear_(linear), linear_solver_(linear) {}

  [[nodiscard]] int increment_count(const std::vector<RigidTransform>& from_X_LB,
                                    const std::vector<RigidTransform>& to_X_LB) const;
  /// Poses of the motion that solve() describes.
  [[nodiscard]] std::vector<RigidTransform> between(const std::vector<RigidTransform>& from_X_LB,
                                                    const std::vector<RigidTransform>& to_X_LB,
                                                    double fraction) const;
  [[nodiscard]] Result<void> factorize_at(const FaceState& state);
  [[nodiscard]] VectorX prescribed_rate(const FaceState& state, const PoseRate& rate) const;
  [[nodiscard]] std::vector<VectorX> explicit_rates(const FaceState& state,
                                                    std::span<const PoseRate> rates) const;
  [[nodiscard]] Result<VectorX> solve_linear(const VectorX& b);

  PredictionOptions options_;
  linear::LinearSolverOptions linear_;
  std::unique_ptr<FaceBody> body_;
  std::vector<Vec3> centers_B_;    ///< Centroid of the vertices of each segment.
  std::vector<double> radius_mm_;  ///< Largest distance of a vertex from it.
  double max_increment_mm_ = 0.0;  ///< Of a vertex of a segment.
  linear::LinearSolver linear_solver_, tangent_solver_;
  Index newton_iterations_ = 0;
};

}  // namespace lefort::predict
