/// \file
/// How the face answers a motion of the segments, in a moment: a preview, not a prediction.
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

/// A face to first order about rest: what a preview is computed from. A value.
struct PreviewModel {
  /// Of the tissue at rest on its free components, lower triangle [N/mm].
  linear::SparseMatrix stiffness_n_per_mm;
  std::vector<std::int32_t> first_row;  ///< Of each node's three rows; -1 where it is fixed.

  /// A point of the tissue that a segment takes along one direction.
  struct Support {
    std::int32_t segment = 0;         ///< Which, in the order of the plan.
    std::int32_t row = 0;             ///< The first of its three.
    Vec3 point_L = Vec3::Zero();      ///< At rest.
    Vec3 direction_L = Vec3::Zero();  ///< Unit length; out of the bone where it only pushes.
    bool is_bilateral = false;        ///< Also pulls: attached tissue has three of these.
  };
  std::vector<Support> supports;
  double support_n_per_mm = 0.0;
  std::int32_t segment_count = 1;
  SkinEmbedding skin;
};

/// \param skin_L      the surface whose displacement is wanted.
/// \param spacing_mm  of the scan.
/// \returns kAnatomyMissing if no tissue lies on a segment, or nothing holds it.
[[nodiscard]] Result<PreviewModel> make_preview_model(const FaceModel& model,
                                                      const geometry::TriangleMesh& skin_L,
                                                      const TissueOptions& tissue,
                                                      const BoundaryOptions& boundary,
                                                      const Vec3& spacing_mm);

/// Small-strain elasticity with the stiffness at rest. Tissue that lies on a segment is pushed
/// along the bone's normal at rest, slides, and comes off where the bone leaves it; attached
/// tissue, and what was painted to move with a segment, goes with the bone. Nothing turns or
/// stretches by more than the first order, and no tissue meets bone that it did not lie on: how far
/// that is from a prediction grows with the motion.
///
/// Safe from many threads, which wait for one another.
class FacePreview {
 public:
  explicit FacePreview(PreviewModel model);
  ~FacePreview();
  FacePreview(FacePreview&&) noexcept;
  FacePreview& operator=(FacePreview&&) noexcept;

  /// \param X_LB  of each segment, in the order of the plan.
  /// \returns the displacement of each skin vertex [mm]; kOutOfMemory or kNotConverged if the
  ///   equations cannot be solved.
  /// \note The first call factorizes. All others iterate with that factor.
  [[nodiscard]] Result<std::vector<Vec3>> displacement_mm(
      std::span<const RigidTransform> X_LB) const;

  [[nodiscard]] Index vertex_count() const;
  [[nodiscard]] std::size_t segment_count() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace lefort::predict
