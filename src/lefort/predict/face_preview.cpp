#include <lefort/core/check.h>
#include <lefort/predict/face_preview.h>
#include <lefort/predict/face_response.h>

#include <algorithm>
#include <array>
#include <mutex>
#include <optional>
#include <utility>

namespace lefort::predict {
namespace {

constexpr double kElementSize_mm = 6.0, kFarElementSize_mm = 12.0;
/// Of the residual, relative: up to a tenth of a mm of the skin
/// (docs/studies/planner-performance.md).
constexpr double kPreviewTolerance = 3e-3;
constexpr int kFollowIterations = 2;  ///< In each increment of an update during a drag.
constexpr double kMoved_mm = 0.5;     ///< As in the summary of a prediction.

using Boxes = std::vector<Eigen::AlignedBox3d>;

Boxes boxes_of(const FaceModel& model) {
  Boxes boxes_B(model.segments.size());
  for (std::size_t k = 0; k < boxes_B.size(); ++k)
    for (const Vec3& vertex : model.segments[k].surface_B.vertices) boxes_B[k].extend(vertex);
  return boxes_B;
}

/// Largest distance of a corner of a segment's box between two sets of poses [mm].
double distance_mm(const Boxes& boxes_B, std::span<const RigidTransform> a_LB,
                   std::span<const RigidTransform> b_LB) {
  double max_mm = 0.0;
  for (std::size_t k = 0; k < boxes_B.size(); ++k)
    for (int corner = 0; corner < 8 && !boxes_B[k].isEmpty(); ++corner) {
      const Vec3 p_B = boxes_B[k].corner(Eigen::AlignedBox3d::CornerType(corner));
      max_mm = std::max(max_mm, (a_LB[k] * p_B - b_LB[k] * p_B).norm());
    }
  return max_mm;
}

}  // namespace

TissueOptions preview_tissue(const TissueOptions& fine) {
  TissueOptions options = fine;
  options.element_size_mm = std::max(fine.element_size_mm, kElementSize_mm);
  options.far_element_size_mm = std::max(fine.far_element_size_mm, kFarElementSize_mm);
  options.element_order = 1;
  options.mucosa.reset();
  options.face.reset();
  return options;
}

struct FacePreview::Live {
  FaceModel model;
  Boxes boxes_B;  ///< Of the segments.
  SkinEmbedding skin;
  std::unique_ptr<FaceResponse> response;  ///< Of `model`.
  FaceState last;                          ///< The last equilibrium.
  std::optional<FaceState> dragged;        ///< Last state of a drag, not in equilibrium.
  mutable std::mutex mutex;

  [[nodiscard]] double distance_from(const FaceState& state,
                                     std::span<const RigidTransform> X_LB) const {
    return distance_mm(boxes_B, X_LB, state.at.X_LB);
  }
  /// The equilibrium that is closer to the poses: the last one, or that at rest.
  [[nodiscard]] FaceState equilibrium_near(std::span<const RigidTransform> X_LB) const;
  /// True if the last state of a drag is at least as close to the poses as `state`.
  [[nodiscard]] bool is_dragged_closer(const FaceState& state,
                                       std::span<const RigidTransform> X_LB) const {
    return dragged && distance_from(*dragged, X_LB) <= distance_from(state, X_LB);
  }
  [[nodiscard]] Result<void> move_to(std::span<const RigidTransform> X_LB);
  [[nodiscard]] Result<void> follow_to(std::span<const RigidTransform> X_LB);
};

FaceState FacePreview::Live::equilibrium_near(std::span<const RigidTransform> X_LB) const {
  LEFORT_CHECK(X_LB.size() == model.segments.size());
  FaceState rest = response->at_rest();
  return distance_from(rest, X_LB) < distance_from(last, X_LB) ? rest : last;
}

Result<void> FacePreview::Live::move_to(std::span<const RigidTransform> X_LB) {
  const FaceState start = equilibrium_near(X_LB);
  const std::vector<RigidTransform> poses(X_LB.begin(), X_LB.end());
  Result<FaceState> found = is_dragged_closer(start, X_LB)
                                ? response->solve_near(poses, start, *dragged)
                                : response->solve(poses, start);
  dragged.reset();
  LEFORT_TRY(last, std::move(found));
  return {};
}

Result<void> FacePreview::Live::follow_to(std::span<const RigidTransform> X_LB) {
  const FaceState start = equilibrium_near(X_LB);
  Result<FaceState> found =
      response->approach({X_LB.begin(), X_LB.end()},
                         is_dragged_closer(start, X_LB) ? *dragged : start, kFollowIterations);
  dragged.reset();
  LEFORT_TRY(dragged, std::move(found));
  return {};
}

Result<FacePreview> FacePreview::create(FaceModel model, std::vector<std::string> names,
                                        const geometry::TriangleMesh& skin_L,
                                        PredictionOptions options, const Vec3& spacing_mm,
                                        Progress& progress) {
  options.contact.integration = contact::Integration::kQuadrature;
  options.contact.detection = contact::DetectionMethod::kSmooth;
  options.solver.relative_tolerance =
      std::max(options.solver.relative_tolerance, kPreviewTolerance);
  auto live = std::make_unique<Live>();
  live->model = std::move(model);
  live->boxes_B = boxes_of(live->model);
  live->skin =
      embed_skin(skin_L, live->model.tissue, embedding_distance_mm(options.tissue, spacing_mm));
  LEFORT_TRY(live->response, FaceResponse::create(live->model, std::move(names), options, progress,
                                                  {.kind = linear::LinearSolverKind::kDirect}));
  live->last = live->response->at_rest();
  return FacePreview(std::move(live));
}

FacePreview::FacePreview(std::unique_ptr<Live> live) : live_(std::move(live)) {}
FacePreview::~FacePreview() = default;
FacePreview::FacePreview(FacePreview&&) noexcept = default;
FacePreview& FacePreview::operator=(FacePreview&&) noexcept = default;

Index FacePreview::vertex_count() const { return Index(live_->skin.embedded_vertices.size()); }

std::size_t FacePreview::segment_count() const { return live_->model.segments.size(); }

Index FacePreview::element_count() const { return live_->model.tissue.element_count(); }

Index FacePreview::newton_iterations() const {
  const std::scoped_lock lock(live_->mutex);
  return live_->response->newton_iterations();
}

Result<std::vector<Vec3>> FacePreview::displacement_mm(std::span<const RigidTransform> X_LB) const {
  const std::scoped_lock lock(live_->mutex);
  LEFORT_TRY_VOID(live_->move_to(X_LB));
  return skin_displacement(live_->skin, live_->last.displacement_mm());
}

Result<std::vector<Vec3>> FacePreview::follow_mm(std::span<const RigidTransform> X_LB) const {
  const std::scoped_lock lock(live_->mutex);
  LEFORT_TRY_VOID(live_->follow_to(X_LB));
  return skin_displacement(live_->skin, live_->dragged->displacement_mm());
}

Result<VertexMotion> FacePreview::vertex_motion(std::span<const RigidTransform> X_LB,
                                                std::size_t segment, Index vertex) const {
  const std::scoped_lock lock(live_->mutex);
  LEFORT_CHECK(segment < segment_count() && vertex >= 0 && vertex < vertex_count());
  LEFORT_TRY_VOID(live_->move_to(X_LB));
  std::vector<PoseRate> rates;
  rates.reserve(3);
  for (int axis = 0; axis < 3; ++axis)
    rates.push_back({{segment, {.translation = Vec3::Unit(axis)}}});
  LEFORT_TRY(const Eigen::MatrixXd du, live_->response->sensitivities(live_->last, rates));
  const SkinEmbedding one{{live_->skin.embedded_vertices[std::size_t(vertex)]}};
  const auto of_vertex = [&](std::span<const Vec3> nodes_mm) {
    return skin_displacement(one, nodes_mm).front();
  };
  VertexMotion motion{.displacement_mm = of_vertex(live_->last.displacement_mm())};
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<Vec3> nodes(std::size_t(du.rows() / 3));
    for (std::size_t n = 0; n < nodes.size(); ++n) nodes[n] = du.col(axis).segment<3>(3 * Index(n));
    motion.by_translation.col(axis) = of_vertex(nodes);
  }
  return motion;
}

PreviewDistance measure_preview(std::span<const Vec3> preview_mm, std::span<const Vec3> before_L,
                                std::span<const Vec3> after_L) {
  LEFORT_CHECK(preview_mm.size() == before_L.size() && after_L.size() == before_L.size());
  PreviewDistance distance;
  std::vector<double> misses_mm;
  for (std::size_t v = 0; v < before_L.size(); ++v) {
    const Vec3 shift_mm = after_L[v] - before_L[v];
    distance.max_shift_mm = std::max(distance.max_shift_mm, shift_mm.norm());
    if (shift_mm.norm() > kMoved_mm) misses_mm.push_back((preview_mm[v] - shift_mm).norm());
  }
  distance.moved_vertices = Index(misses_mm.size());
  if (misses_mm.empty()) return distance;
  std::sort(misses_mm.begin(), misses_mm.end());
  const auto quantile = [&](double q) {
    return misses_mm[std::size_t(q * double(misses_mm.size() - 1))];
  };
  distance.p50_mm = quantile(0.5);
  distance.p99_mm = quantile(0.99);
  distance.max_mm = misses_mm.back();
  return distance;
}

}  // namespace lefort::predict
