#include <lefort/contact/measure_gap.h>
#include <lefort/core/check.h>
#include <lefort/fem/assembly/assemble.h>
#include <lefort/fem/assembly/boundary_conditions.h>
#include <lefort/fem/assembly/dof_map.h>
#include <lefort/fem/assembly/element_term.h>
#include <lefort/linear/linear_solver.h>
#include <lefort/predict/face_preview.h>
#include <lefort/predict/tissue_boundary.h>
#include <lefort/predict/tissue_materials.h>

#include <algorithm>
#include <mutex>
#include <utility>

namespace lefort::predict {
namespace {

/// A support's stiffness over the mean of the nodes it stands at: so stiff that what it gives way
/// does not show, so soft that one factor serves whichever supports push.
constexpr double kSupportStiffness = 10.0;
/// Where the field's gradient is shorter, it knows no way out of the bone.
constexpr double kKnowsTheWay = 0.5;
constexpr double kTolerance = 1e-5;  ///< Of the linear systems: micrometers.
constexpr int kRounds = 8;           ///< Of finding which supports push, at most.
constexpr std::size_t kFewOf = 400;  ///< One support in so many may still change.
constexpr double kAtRest_mm = 1e-9;

Error describe(linear::LinearSolveStatus outcome) {
  if (outcome == linear::LinearSolveStatus::kOutOfMemory)
    return {ErrorCode::kOutOfMemory,
            "the preview's equations do not fit into memory: ask for a larger "
            "tissue.element_size_mm"};
  return {ErrorCode::kNotConverged, "the preview's equations cannot be solved"};
}

/// Along the bone's normal, or along all axes where tissue moves with the segment.
Result<std::vector<PreviewModel::Support>> find_supports(const FaceModel& model,
                                                         const std::vector<std::int32_t>& first_row,
                                                         SegmentInterface segment_interface) {
  const mesh::VolumeMesh& tissue = model.tissue;
  const std::vector<std::int32_t> attached = nodes_with_segment(tissue, segment_interface);
  const auto prescribed = nodes_by_segment(model, attached);
  const auto near = nodes_by_segment(model, nodes_on_segment(tissue));
  std::vector<PreviewModel::Support> supports;
  for (std::size_t k = 0; k < model.segments.size(); ++k) {
    for (const std::int32_t node : prescribed[k])
      for (int axis = 0; axis < 3; ++axis)
        supports.push_back({.segment = std::int32_t(k),
                            .row = first_row[std::size_t(node)],
                            .point_L = tissue.nodes_L[std::size_t(node)],
                            .direction_L = Vec3::Unit(axis),
                            .is_bilateral = true});
    if (segment_interface == SegmentInterface::kBonded) continue;
    LEFORT_TRY(const auto distance_query_B,
               contact::field_distance_query(model.segments[k].field_B,
                                             contact::DetectionMethod::kTrilinear));
    for (const std::int32_t node : near[k]) {
      if (std::binary_search(attached.begin(), attached.end(), node)) continue;
      const Vec3& point_L = tissue.nodes_L[std::size_t(node)];
      const Vec3 gradient_L =
          contact::measure_gap({distance_query_B}, point_L, contact::Derivatives::kFirst)
              .gradient_L;
      if (gradient_L.norm() < kKnowsTheWay) continue;
      supports.push_back({.segment = std::int32_t(k),
                          .row = first_row[std::size_t(node)],
                          .point_L = point_L,
                          .direction_L = gradient_L.normalized()});
    }
  }
  return supports;
}

}  // namespace

Result<PreviewModel> make_preview_model(const FaceModel& model,
                                        const geometry::TriangleMesh& skin_L,
                                        const TissueOptions& options,
                                        const BoundaryOptions& boundary, const Vec3& spacing_mm) {
  const mesh::VolumeMesh& tissue = model.tissue;
  const std::vector<std::int32_t>& fixed = tissue.node_sets.at(sets::kFixed);
  if (tissue.face_sets.contains(sets::kStationaryContact))
    return fail(ErrorCode::kPlanInvalid,
                "boundary.labels: the preview knows no tissue painted to slide on still bone");
  if (nodes_on_segment(tissue).empty() &&
      nodes_with_segment(tissue, boundary.segment_interface).empty())
    return fail(ErrorCode::kAnatomyMissing, "no soft tissue lies on the segment");
  if (fixed.empty()) return fail(ErrorCode::kAnatomyMissing, "nothing holds the soft tissue");
  LEFORT_TRY(const fem::RegionMaterials materials, materials_of(options));
  LEFORT_TRY(const auto elements, fem::make_element_terms(tissue, materials));
  std::vector<const fem::ForceTerm*> terms;
  for (const auto& term : elements) terms.push_back(term.get());
  LEFORT_TRY(fem::DofMap dofs, fem::DofMap::build(tissue.node_count(), fem::prescribe_zero(fixed)));
  const fem::Assembler assembler(tissue.nodes_L, std::move(dofs), terms);

  PreviewModel preview;
  preview.segment_count = std::int32_t(model.segments.size());
  preview.stiffness_n_per_mm = assembler.tangent(VectorX::Zero(3 * tissue.node_count()));
  for (Index node = 0; node < tissue.node_count(); ++node)
    preview.first_row.push_back(assembler.dofs().free_number(3 * node));
  LEFORT_TRY(preview.supports, find_supports(model, preview.first_row, boundary.segment_interface));
  if (preview.supports.empty())
    return fail(ErrorCode::kAnatomyMissing,
                "the segment's field tells no way out of the bone where tissue lies on it");
  const VectorX diagonal = preview.stiffness_n_per_mm.diagonal();
  double sum = 0.0;
  for (const PreviewModel::Support& support : preview.supports)
    sum += diagonal.segment<3>(support.row).mean();
  if (!preview.supports.empty())
    preview.support_n_per_mm = kSupportStiffness * sum / double(preview.supports.size());
  preview.skin = embed_skin(skin_L, tissue, embedding_distance_mm(options, spacing_mm));
  return preview;
}

struct FacePreview::Parts {
  explicit Parts(PreviewModel model_of) : model(std::move(model_of)) {}

  PreviewModel model;
  std::mutex mutex;
  linear::LinearSolver solver{{.kind = linear::LinearSolverKind::kReusedFactor}};
  bool is_factorized = false;

  /// With those supports that push.
  [[nodiscard]] linear::SparseMatrix stiffness(const std::vector<char>& pushes) const;
  [[nodiscard]] Result<VectorX> solve(const std::vector<char>& pushes,
                                      const std::vector<double>& pushed_mm);
};

linear::SparseMatrix FacePreview::Parts::stiffness(const std::vector<char>& pushes) const {
  linear::SparseMatrix K = model.stiffness_n_per_mm;
  for (std::size_t s = 0; s < pushes.size(); ++s) {
    if (!pushes[s]) continue;
    const auto& [segment, row, point_L, n, is_bilateral] = model.supports[s];
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j <= i; ++j)
        K.coeffRef(row + i, row + j) += model.support_n_per_mm * n[i] * n[j];
  }
  return K;
}

Result<VectorX> FacePreview::Parts::solve(const std::vector<char>& pushes,
                                          const std::vector<double>& pushed_mm) {
  VectorX push_n = VectorX::Zero(model.stiffness_n_per_mm.rows());
  for (std::size_t s = 0; s < pushes.size(); ++s)
    if (pushes[s])
      push_n.segment<3>(model.supports[s].row) +=
          model.support_n_per_mm * pushed_mm[s] * model.supports[s].direction_L;
  if (const auto done = solver.factorize(stiffness(pushes));
      done != linear::LinearSolveStatus::kDone)
    return tl::unexpected(describe(done));
  auto u = solver.solve(push_n, kTolerance);
  if (!u) return tl::unexpected(describe(u.error()));
  return *std::move(u);
}

FacePreview::FacePreview(PreviewModel model) : parts_(std::make_unique<Parts>(std::move(model))) {}
FacePreview::~FacePreview() = default;
FacePreview::FacePreview(FacePreview&&) noexcept = default;
FacePreview& FacePreview::operator=(FacePreview&&) noexcept = default;

Index FacePreview::vertex_count() const {
  return Index(parts_->model.skin.embedded_vertices.size());
}

std::size_t FacePreview::segment_count() const { return std::size_t(parts_->model.segment_count); }

Result<std::vector<Vec3>> FacePreview::displacement_mm(std::span<const RigidTransform> X_LB) const {
  Parts& parts = *parts_;
  const PreviewModel& model = parts.model;
  LEFORT_CHECK(X_LB.size() == segment_count());
  const std::scoped_lock lock(parts.mutex);
  const std::size_t count = model.supports.size();
  if (!parts.is_factorized) {  // With all supports: near to whatever is asked for.
    const auto done = parts.solver.factorize(parts.stiffness(std::vector<char>(count, 1)));
    if (done != linear::LinearSolveStatus::kDone) return tl::unexpected(describe(done));
    parts.is_factorized = true;
  }
  std::vector<double> pushed_mm(count);
  std::vector<char> pushes(count, 1);
  bool is_at_rest = true;
  for (std::size_t s = 0; s < count; ++s) {
    const Vec3& p = model.supports[s].point_L;
    const RigidTransform& X = X_LB[std::size_t(model.supports[s].segment)];
    pushed_mm[s] = model.supports[s].direction_L.dot(X * p - p);
    is_at_rest = is_at_rest && std::abs(pushed_mm[s]) < kAtRest_mm;
    pushes[s] = model.supports[s].is_bilateral || pushed_mm[s] > 0.0;
  }
  VectorX u = VectorX::Zero(model.stiffness_n_per_mm.rows());
  for (int round = 0; round < kRounds && !is_at_rest; ++round) {
    LEFORT_TRY(u, parts.solve(pushes, pushed_mm));
    std::size_t changed = 0;
    for (std::size_t s = 0; s < count; ++s) {
      const auto& [segment, row, point_L, n, is_bilateral] = model.supports[s];
      const char should = is_bilateral || pushed_mm[s] > n.dot(u.segment<3>(row));
      changed += should != pushes[s];
      pushes[s] = should;
    }
    if (changed <= count / kFewOf) break;
  }
  std::vector<Vec3> nodes_mm(model.first_row.size(), Vec3::Zero());
  for (std::size_t node = 0; node < nodes_mm.size(); ++node)
    if (model.first_row[node] >= 0) nodes_mm[node] = u.segment<3>(model.first_row[node]);
  return skin_displacement(model.skin, nodes_mm);
}

}  // namespace lefort::predict
