/// \file
/// The objective of inverse planning: the predicted face compared with a target, bone overlap, and
/// the distance from the given plan, with exact derivatives by the numbers of the movements.
///
///   J(x) = 1/2 sum_k w_k mean r_k(d(x))^2  +  c/2 sum_v max(depth_v - threshold, 0)^2
///          +  w_r/2 |x - x_0|^2
///
/// d(x) is the displacement of the skin: that of the live model, plus a constant correction of
/// each vertex (optimize_motion.h).
#pragma once

#include <lefort/core/progress.h>
#include <lefort/core/types.h>
#include <lefort/inverse/bone_clearance.h>
#include <lefort/inverse/bounded_least_squares.h>
#include <lefort/inverse/observe_face.h>
#include <lefort/inverse/rigid_bodies.h>
#include <lefort/predict/embed_skin.h>
#include <lefort/predict/face_response.h>

#include <optional>
#include <vector>

namespace lefort::inverse {

/// A live model with the skin that it displaces.
struct LiveFace {
  predict::FaceResponse* response = nullptr;
  predict::SkinEmbedding embedding;
};

/// What is wanted, and by which movements. The referenced objects must outlive it.
struct MotionProblem {
  const FaceObserver& observer;
  const MotionVariables& variables;
  const BoneClearance& clearance;
  double regularization = 0.0;  ///< w_r >= 0 [mm^2 per mm^2 or deg^2].
};

/// First c, the weight of a vertex in the overlap penalty [mm^2 per mm^2].
inline constexpr double kOverlapWeight = 1.0;

/// A face that the live model has found.
struct FaceAt {
  VectorX x;
  predict::FaceState state;
  std::vector<Vec3> skin_mm;  ///< Displacement of each vertex, with the correction.
  std::vector<Observation> observations;
  double objective = 0.0;
  double target_objective = 0.0;  ///< Its first sum.
};

class FaceObjective final : public LeastSquaresFunction {
 public:
  /// \param face      must outlive the objective.
  /// \param problem   the same.
  /// \param start     equilibrium from which the first point is solved.
  /// \param progress  may stop a solve.
  FaceObjective(LiveFace& face, const MotionProblem& problem, predict::FaceState start,
                Progress& progress);

  /// Displacements that are added to those of the model [mm], one for each vertex.
  void set_correction(std::vector<Vec3> correction_mm) {
    correction_mm_ = std::move(correction_mm);
  }
  [[nodiscard]] const std::vector<Vec3>& correction_mm() const { return correction_mm_; }

  /// Multiplies c. \param factor  > 0.
  void scale_overlap_weight(double factor) { overlap_weight_ *= factor; }

  [[nodiscard]] Result<double> evaluate(const VectorX& x) override;
  void accept() override;
  [[nodiscard]] Result<QuadraticModel> linearize() override;

  /// The accepted point. \pre accept() has been called.
  [[nodiscard]] const FaceAt& present() const { return *present_; }
  /// The last point of evaluate(). \pre it returned a value.
  [[nodiscard]] const FaceAt& trial() const { return *trial_; }
  /// H of the targets alone at the last linearize() [mm^2 per mm or deg squared].
  [[nodiscard]] const Eigen::MatrixXd& target_hessian() const { return target_hessian_; }

  /// Gradient of the part of J of each target at the last linearize(); one row for each target.
  [[nodiscard]] const Eigen::MatrixXd& target_gradients() const { return target_gradients_; }

  /// Compares the gradient at the last linearize() with central differences of J: of the targets,
  /// and of overlap and distance from the given plan, each on its own. Bone overlap is summed over
  /// vertices and would hide the derivatives of the face.
  /// \param step  of each number [mm, deg], > 0.
  /// \returns the larger of both differences, each relative to the largest component of its part;
  ///   or the error of a solve.
  [[nodiscard]] Result<double> gradient_error(const VectorX& gradient, double step);

 private:
  [[nodiscard]] Result<FaceAt> solve(const VectorX& x, const predict::FaceState& from);

  LiveFace& face_;
  const MotionProblem& problem_;
  predict::FaceState start_;
  Progress& progress_;
  std::vector<Vec3> correction_mm_;
  double overlap_weight_ = kOverlapWeight;
  std::optional<FaceAt> present_, trial_;
  Eigen::MatrixXd target_hessian_, target_gradients_;
};

}  // namespace lefort::inverse
