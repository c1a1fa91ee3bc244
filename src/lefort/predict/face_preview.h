/// \file
/// Interactive linear preview of the face for given segment poses.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/linear/sparse_matrix.h>
#include <lefort/predict/embed_skin.h>
#include <lefort/predict/predict_face.h>
#include <lefort/predict/prediction_options.h>

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace lefort::predict {

/// The linearized face at rest. A value.
struct PreviewModel {
  /// Tangent of the tissue at rest on its free components, lower triangle [N/mm].
  linear::SparseMatrix stiffness_n_per_mm;
  std::vector<std::int32_t> first_row;  ///< First of the three rows of each node; -1 if fixed.

  /// A support of a node in one direction: by a segment, by stationary bone or in a plane.
  struct Support {
    std::int32_t segment = 0;         ///< Its index, in the order of the plan; -1: stationary.
    std::int32_t row = 0;             ///< First of the three rows of its node.
    Vec3 point_L = Vec3::Zero();      ///< At rest.
    Vec3 direction_L = Vec3::Zero();  ///< Unit length; out of the bone if unilateral.
    bool is_bilateral = false;        ///< Pulls too; bonded tissue has three of these.
    double n_per_mm = 0.0;            ///< Stiffness; 0: support_n_per_mm.
    double motion_fraction = 1.0;     ///< Of the segment's motion that the support follows.
  };
  std::vector<Support> supports;
  double support_n_per_mm = 0.0;  ///< Stiffness of supports with n_per_mm = 0.
  std::int32_t segment_count = 1;
  SkinEmbedding skin;
};

/// \param model       the face at rest.
/// \param skin_L      the surface whose displacement is computed.
/// \param tissue      materials and element size.
/// \param boundary    its interface is used.
/// \param spacing_mm  of the scan.
/// \returns the model; or
///   - kAnatomyMissing   no tissue lies on a segment, nothing is fixed, or no segment supports
///     tissue;
///   - kPlanInvalid      tissue is painted as contact, and the interface is not kClinical;
///   - kInvalidArgument  a material constant lies outside its range;
///   - what fem::make_element_terms() returns.
[[nodiscard]] Result<PreviewModel> make_preview_model(const FaceModel& model,
                                                      const geometry::TriangleMesh& skin_L,
                                                      const TissueOptions& tissue,
                                                      const BoundaryOptions& boundary,
                                                      const Vec3& spacing_mm);

/// Small-strain elasticity with the tangent at rest. With kContact a segment pushes the tissue on
/// it along the normal of the bone at rest; the tissue slides, and lifts off where the bone
/// retreats. With kClinical the interface map gives the elastic supports. Bonded tissue, and tissue
/// painted to move with a segment, moves with the bone. Tissue touches only bone on which it lies
/// at rest, and the lips do not touch each other. The difference from a prediction therefore grows
/// with the motion.
///
/// Thread-safe; calls run one at a time.
class FacePreview {
 public:
  explicit FacePreview(PreviewModel model);
  ~FacePreview();
  FacePreview(FacePreview&&) noexcept;
  FacePreview& operator=(FacePreview&&) noexcept;

  /// \param X_LB  pose of each segment, in the order of the plan.
  /// \returns the displacement of each skin vertex [mm]; kOutOfMemory or kNotConverged if the
  ///   equations cannot be solved.
  /// \note The first call factorizes; later calls iterate with that factor.
  [[nodiscard]] Result<std::vector<Vec3>> displacement_mm(
      std::span<const RigidTransform> X_LB) const;

  [[nodiscard]] Index vertex_count() const;
  [[nodiscard]] std::size_t segment_count() const;

 private:
  struct Solver;
  std::unique_ptr<Solver> solver_;
};

}  // namespace lefort::predict
