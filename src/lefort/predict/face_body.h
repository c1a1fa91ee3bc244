/// \file
/// The tissue of a face with all that acts on it: elements, contact, supports, lips and prescribed
/// nodes. Its bones can be posed, and its equilibrium be found from a start.
#pragma once

#include <lefort/contact/contact_term.h>
#include <lefort/contact/rigid_obstacle.h>
#include <lefort/contact/support_term.h>
#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/core/types.h>
#include <lefort/fem/assembly/assemble.h>
#include <lefort/fem/assembly/dof_map.h>
#include <lefort/fem/assembly/element_term.h>
#include <lefort/fem/solve/newton.h>
#include <lefort/linear/linear_solver.h>
#include <lefort/predict/check_query_range.h>
#include <lefort/predict/face_lips.h>
#include <lefort/predict/face_model.h>
#include <lefort/predict/face_prediction.h>
#include <lefort/predict/lip_contact.h>
#include <lefort/predict/predict_face.h>
#include <lefort/predict/weighted_contacts.h>

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lefort::predict {

/// An equilibrium: poses of the bones and displacements of all nodes.
struct FaceEquilibrium {
  std::vector<RigidTransform> X_LB;  ///< One for each segment.
  VectorX u;                         ///< Three per node [mm].
  VectorX paired_u = {};             ///< Where its lips are paired; empty: at u.
};

/// Called after each Newton iteration; `is_start` at the start of each solve.
using OnBodyIterate =
    std::function<void(const fem::NewtonIterate&, const fem::ResidualState&, bool is_start)>;

/// The assembler points to elements and contacts of this object, which therefore never moves.
class FaceBody {
 public:
  /// The body at rest.
  /// \param model               must outlive the result; as in predict_face().
  /// \param names               of the segments, for messages.
  /// \param distance_queries_B  of the segments.
  /// \param options             must outlive the result.
  /// \param progress            receives warnings.
  /// \returns as predict_face().
  [[nodiscard]] static Result<std::unique_ptr<FaceBody>> create(
      const FaceModel& model, std::vector<std::string> names,
      const DistanceQueries& distance_queries_B, const PredictionOptions& options,
      Progress& progress);

  /// \param X_LB  pose of each segment.
  void set_poses(std::span<const RigidTransform> X_LB);

  /// Restores poses and pairs of the lips of an equilibrium, so that the assembler is in it.
  void set_equilibrium(const FaceEquilibrium& at);

  /// Finds the equilibrium at `X_LB`.
  ///
  /// \param last           the last equilibrium, where the lips are paired.
  /// \param X_LB           pose of each segment.
  /// \param start          displacements of all components from which the solve starts [mm].
  /// \param linear_solver  as in fem::solve_newton().
  /// \param on_iterate     may be empty.
  /// \returns as fem::find_equilibrium().
  [[nodiscard]] fem::NewtonOutcome solve(const FaceEquilibrium& last,
                                         const std::vector<RigidTransform>& X_LB,
                                         const VectorX& start, linear::LinearSolver& linear_solver,
                                         Progress& progress, const OnBodyIterate& on_iterate = {});

  /// Newton iterations towards the equilibrium at `X_LB`, without the checks of an equilibrium.
  ///
  /// \param start       displacements of all components from which they start, and where the lips
  ///                    are paired [mm].
  /// \param iterations  max number, >= 1.
  [[nodiscard]] fem::NewtonOutcome approach(const std::vector<RigidTransform>& X_LB,
                                            const VectorX& start, int iterations,
                                            linear::LinearSolver& linear_solver);

  /// Sets poses, contacts, supports, displacements and min_J of `step`.
  /// \param at  the present equilibrium.
  void summarize(const FaceEquilibrium& at, PredictionStep& step) const;

  /// FacePrediction::nodal_contacts.
  [[nodiscard]] std::vector<std::vector<contact::NodalContact>> nodal_contacts(
      const VectorX& u) const;

  [[nodiscard]] const FaceModel& model() const { return model_; }
  [[nodiscard]] const PredictionOptions& options() const { return options_; }
  [[nodiscard]] const fem::Assembler& assembler() const { return *assembler_; }
  /// \returns the nodes that move with each segment.
  [[nodiscard]] const std::vector<std::vector<std::int32_t>>& bonded() const { return bonded_; }
  /// \returns the displacements of all prescribed nodes at poses of the segments.
  [[nodiscard]] std::vector<fem::PrescribedDisplacement> prescribed_at(
      std::span<const RigidTransform> X_LB) const;
  [[nodiscard]] double penalty_stiffness_mpa_per_mm() const { return stiffness_mpa_per_mm_; }
  [[nodiscard]] double rest_penetration_mm() const { return rest_penetration_mm_; }
  /// \returns contact of each segment; empty if tissue touches none, or with weighted gaps.
  [[nodiscard]] std::span<const contact::ContactTerm> segment_contacts() const {
    return std::span(contacts_).first(segment_contact_count_);
  }
  [[nodiscard]] const WeightedContacts& weighted_contacts() const { return weighted_; }
  /// \returns supports on each segment.
  [[nodiscard]] const std::vector<contact::SupportTerm>& segment_supports() const {
    return segment_supports_;
  }
  /// \returns contact::NodalSupport::motion_fraction of each support on each segment.
  [[nodiscard]] const std::vector<std::vector<double>>& motion_fractions() const {
    return motion_fractions_;
  }

 private:
  FaceBody(const FaceModel& model, std::vector<std::string> names, const PredictionOptions& options)
      : model_(model), names_(std::move(names)), options_(options) {}

  [[nodiscard]] Result<void> add_contacts(const DistanceQueries& distance_queries_B,
                                          Progress& progress);
  void add_contact(const std::vector<contact::RigidObstacle>& bones, std::size_t bone,
                   const std::string& name, const std::vector<mesh::Face>& faces);
  void add_weighted_contacts(const std::vector<contact::RigidObstacle>& bones, Progress& progress);
  [[nodiscard]] contact::WeightedContactTerm::Options weighted_options() const;
  void note_rest_penetration(double inside_mm, const std::string& bone, Progress& progress);
  void add_supports(const std::vector<contact::RigidObstacle>& bones);
  [[nodiscard]] Result<fem::DofMap> make_dofs() const;
  void make_assembler(fem::DofMap dofs);
  /// Finds the points of contact of the lips at displacements `u`.
  void update_lips(const VectorX& u);
  /// Solves with contact by quadrature; rejects an equilibrium by ContactTerm::rejection_reason().
  [[nodiscard]] fem::NewtonOutcome solve_with_quadrature(
      const FaceEquilibrium& last, const VectorX& start,
      const std::function<fem::NewtonOutcome(const VectorX& from, int max_iterations)>& solve);
  [[nodiscard]] fem::NewtonOutcome solve_from(const std::vector<RigidTransform>& X_LB,
                                              const VectorX& start, int max_iterations,
                                              linear::LinearSolver& linear_solver,
                                              Progress& progress, const OnBodyIterate& on_iterate);

  const FaceModel& model_;
  std::vector<std::string> names_;
  const PredictionOptions& options_;

  std::vector<std::vector<std::int32_t>> bonded_;
  fem::RegionMaterials materials_;
  std::vector<std::unique_ptr<const fem::ForceTerm>> elements_;
  /// With each segment, if tissue slides on them; then with stationary bone, if it slides there.
  std::vector<contact::ContactTerm> contacts_;
  std::size_t segment_contact_count_ = 0;
  WeightedContacts weighted_;
  std::vector<contact::SupportTerm> segment_supports_;     ///< One for each segment.
  std::vector<std::vector<double>> motion_fractions_;      ///< Of their supports.
  std::vector<contact::SupportTerm> stationary_supports_;  ///< On bone and planes.
  std::array<LipSurface, 2> lip_surfaces_;                 ///< Empty if they are not separated.
  std::optional<LipContact> lips_;                         ///< If they are separated.
  std::optional<fem::Assembler> assembler_;
  double stiffness_mpa_per_mm_ = 0.0;  ///< k_c; 0 without contact.
  double rest_penetration_mm_ = 0.0;   ///< Of the tissue into segments at rest.
};

}  // namespace lefort::predict
