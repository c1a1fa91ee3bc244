/// \file
/// Interactive preview of the face: the equilibrium of a coarse model, kept live while bones are
/// moved.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/core/types.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/predict/embed_skin.h>
#include <lefort/predict/face_model.h>
#include <lefort/predict/predict_face.h>

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace lefort::predict {

/// The mesh of a preview: linear elements of at least 6 mm near the segments and 12 mm far from
/// them, without separate mucosa and without finer lips and nose.
///
/// \param fine  of the plan; materials are unchanged.
[[nodiscard]] TissueOptions preview_tissue(const TissueOptions& fine);

/// Displacement of a vertex of the skin, and its derivative by the translation of a segment.
struct VertexMotion {
  Vec3 displacement_mm = Vec3::Zero();
  Mat3 by_translation = Mat3::Zero();  ///< Column a: by a translation along axis a of L.
};

/// The equations of a prediction on a coarse mesh: large strains, contact by quadrature, supports
/// and lips as in predict_face(). Only the size of the elements and the tolerance of the
/// equilibrium differ. Each call starts from the last equilibrium, or from rest if that is closer,
/// so that a small motion takes a few iterations of Newton's method. Contact has no history, so the
/// starting point changes the result by the tolerance of the equilibrium only, unless the tissue
/// has several equilibria (docs/studies/planner-performance.md).
///
/// Thread-safe; calls run one at a time.
class FacePreview {
 public:
  /// \param model       the face at rest, on the mesh of preview_tissue(). Its obstacles may be
  ///   those of a finer mesh.
  /// \param names       of its segments, for messages.
  /// \param skin_L      the surface whose displacement is computed.
  /// \param options     with preview_tissue(). Contact is always by quadrature with the smooth
  ///   field; the relative tolerance is at least 3e-3.
  /// \param spacing_mm  of the scan.
  /// \param progress    receives warnings.
  /// \returns the preview at rest, or the errors of FaceResponse::create().
  [[nodiscard]] static Result<FacePreview> create(FaceModel model, std::vector<std::string> names,
                                                  const geometry::TriangleMesh& skin_L,
                                                  PredictionOptions options, const Vec3& spacing_mm,
                                                  Progress& progress = Progress::none());
  ~FacePreview();
  FacePreview(FacePreview&&) noexcept;
  FacePreview& operator=(FacePreview&&) noexcept;

  /// \param X_LB  pose of each segment, in the order of the plan.
  /// \returns the displacement of each skin vertex [mm]; or the errors of FaceResponse::solve(),
  ///   after which the last equilibrium is kept.
  [[nodiscard]] Result<std::vector<Vec3>> displacement_mm(
      std::span<const RigidTransform> X_LB) const;

  /// As displacement_mm() during a drag: two Newton iterations in each increment from the last
  /// state, or the equilibrium if there are more than three increments. The face follows the bones
  /// within some updates; after the drag displacement_mm() finds the equilibrium.
  [[nodiscard]] Result<std::vector<Vec3>> follow_mm(std::span<const RigidTransform> X_LB) const;

  /// \param segment  that is translated.
  /// \param vertex   of the skin.
  /// \returns its motion at `X_LB`, or the errors of FaceResponse::solve() and
  ///   FaceResponse::sensitivities().
  [[nodiscard]] Result<VertexMotion> vertex_motion(std::span<const RigidTransform> X_LB,
                                                   std::size_t segment, Index vertex) const;

  [[nodiscard]] Index vertex_count() const;
  [[nodiscard]] std::size_t segment_count() const;
  [[nodiscard]] Index element_count() const;
  /// Newton iterations of all calls since construction.
  [[nodiscard]] Index newton_iterations() const;

 private:
  struct Live;
  explicit FacePreview(std::unique_ptr<Live> live);
  std::unique_ptr<Live> live_;
};

/// Differences between a preview and the full solution, at vertices that the full solution moves by
/// more than 0.5 mm.
struct PreviewDistance {
  Index moved_vertices = 0;
  double p50_mm = 0.0, p99_mm = 0.0, max_mm = 0.0;
  double max_shift_mm = 0.0;  ///< Of the full solution.
};

/// Compares a preview with the full solution.
///
/// \param preview_mm  displacement of each vertex in the preview.
/// \param before_L    vertices of the skin before surgery, as many as in `preview_mm`.
/// \param after_L     the same vertices in the full solution.
[[nodiscard]] PreviewDistance measure_preview(std::span<const Vec3> preview_mm,
                                              std::span<const Vec3> before_L,
                                              std::span<const Vec3> after_L);

}  // namespace lefort::predict
