#include <lefort/contact/measure_gap.h>
#include <lefort/core/check.h>
#include <lefort/fem/assembly/assemble.h>
#include <lefort/fem/assembly/boundary_conditions.h>
#include <lefort/fem/assembly/dof_map.h>
#include <lefort/fem/assembly/element_term.h>
#include <lefort/linear/linear_solver.h>
#include <lefort/predict/face_preview.h>
#include <lefort/predict/interface_supports.h>
#include <lefort/predict/tissue_boundary.h>
#include <lefort/predict/tissue_materials.h>

#include <algorithm>
#include <array>
#include <mutex>
#include <span>
#include <utility>

namespace lefort::predict {
namespace {

/// Stiffness of a support divided by the mean diagonal entry of the supported nodes: stiff enough
/// that its deformation is not visible, soft enough that one factor preconditions all sets of
/// active supports.
constexpr double kSupportStiffness = 10.0;
/// A shorter gradient of the field gives no direction out of the bone (medial surface).
constexpr double kMinGradient = 0.5;
constexpr double kTolerance = 1e-5;  ///< Relative, of the linear systems: micrometers of motion.
constexpr int kMaxRounds = 8;        ///< Of the search for the active supports.
/// The search ends when at most one support in this number changes.
constexpr std::size_t kSupportsPerChange = 400;
constexpr double kAtRest_mm = 1e-9;  ///< Smaller displacements of supports count as zero.

Error describe(linear::LinearSolveStatus outcome) {
  if (outcome == linear::LinearSolveStatus::kOutOfMemory)
    return {ErrorCode::kOutOfMemory,
            "the preview's equations do not fit into memory: use a larger tissue.element_size_mm"};
  return {ErrorCode::kNotConverged, "the preview's equations cannot be solved"};
}

/// Supports along the bone's normal, or along all axes where tissue moves with the segment.
Result<std::vector<PreviewModel::Support>> find_supports(const FaceModel& model,
                                                         const std::vector<std::int32_t>& first_row,
                                                         TissueInterface interface) {
  const mesh::VolumeMesh& tissue = model.tissue;
  const std::vector<std::int32_t> bonded = nodes_with_segment(tissue, interface);
  const auto prescribed = bonded_by_segment(model, interface);
  const auto touching = nodes_by_segment(model, nodes_on_segment(tissue));
  std::vector<PreviewModel::Support> supports;
  for (std::size_t k = 0; k < model.segments.size(); ++k) {
    for (const std::int32_t node : prescribed[k])
      for (int axis = 0; axis < 3; ++axis)
        supports.push_back({.segment = std::int32_t(k),
                            .row = first_row[std::size_t(node)],
                            .point_L = tissue.nodes_L[std::size_t(node)],
                            .direction_L = Vec3::Unit(axis),
                            .is_bilateral = true});
    if (interface != TissueInterface::kContact) continue;
    LEFORT_TRY(const auto distance_query_B,
               contact::field_distance_query(model.segments[k].field_B,
                                             contact::DetectionMethod::kTrilinear));
    for (const std::int32_t node : touching[k]) {
      if (std::binary_search(bonded.begin(), bonded.end(), node)) continue;
      const Vec3& point_L = tissue.nodes_L[std::size_t(node)];
      const Vec3 gradient_L =
          contact::measure_gap({distance_query_B}, point_L, contact::Derivatives::kFirst)
              .gradient_L;
      if (gradient_L.norm() < kMinGradient) continue;
      supports.push_back({.segment = std::int32_t(k),
                          .row = first_row[std::size_t(node)],
                          .point_L = point_L,
                          .direction_L = gradient_L.normalized()});
    }
  }
  return supports;
}

/// A spring of the preview: along a direction, and whether it pulls, too.
struct SupportSpring {
  Vec3 direction_L;
  double mpa_per_mm;
  bool is_bilateral;
};

/// Elevated tissue: only contact pushes it.
bool has_contact_only(const contact::NodalSupport& support) {
  return support.follows_surface && support.normal_mpa_per_mm == 0.0;
}

/// The springs of a support: tension acts both ways, the rest of the stiffness in compression only.
std::array<SupportSpring, 4> springs_of(const contact::NodalSupport& support) {
  const Vec3& n = support.normal_B;
  const Vec3 tangent = n.unitOrthogonal();
  const double pushes = support.normal_mpa_per_mm - support.tension_mpa_per_mm;
  return {{{n, support.tension_mpa_per_mm, true},
           {n, pushes, false},
           {tangent, support.tangential_mpa_per_mm, true},
           {n.cross(tangent), support.tangential_mpa_per_mm, true}}};
}

/// Turns supports that follow the surface of a bone to its direction out of the bone.
Result<void> turn_to_bone(const ContactBone& bone, std::span<const Vec3> nodes_L,
                          std::vector<contact::NodalSupport>& supports) {
  if (std::ranges::none_of(supports, &contact::NodalSupport::follows_surface)) return {};
  LEFORT_TRY(const auto distance_query_B,
             contact::field_distance_query(bone.field_B, contact::DetectionMethod::kTrilinear));
  for (contact::NodalSupport& one : supports) {
    if (!one.follows_surface) continue;
    const Vec3 gradient_L = contact::measure_gap({distance_query_B}, nodes_L[std::size_t(one.node)],
                                                 contact::Derivatives::kFirst)
                                .gradient_L;
    if (gradient_L.norm() >= kMinGradient) one.normal_B = gradient_L.normalized();
  }
  return {};
}

/// Adds the elastic supports of the interface map, and contact below elevated tissue.
Result<void> add_interface_supports(const FaceModel& model, const TissueOptions& tissue,
                                    const BoundaryOptions& boundary,
                                    const std::vector<std::int32_t>& first_row,
                                    std::vector<PreviewModel::Support>& supports) {
  InterfaceSupports all =
      interface_supports(model.tissue, model.interface, model.segments.size(), tissue, boundary);
  const auto add = [&](const std::vector<contact::NodalSupport>& list, std::int32_t segment) {
    for (const contact::NodalSupport& one : list) {
      const std::int32_t row = first_row[std::size_t(one.node)];
      if (row < 0) continue;
      const Vec3& point_L = model.tissue.nodes_L[std::size_t(one.node)];
      if (has_contact_only(one))
        supports.push_back(
            {.segment = segment, .row = row, .point_L = point_L, .direction_L = one.normal_B});
      for (const SupportSpring& spring : springs_of(one))
        if (spring.mpa_per_mm > 0.0)
          supports.push_back({.segment = segment,
                              .row = row,
                              .point_L = point_L,
                              .direction_L = spring.direction_L,
                              .is_bilateral = spring.is_bilateral,
                              .n_per_mm = one.area_mm2 * spring.mpa_per_mm,
                              .motion_fraction = one.motion_fraction});
    }
  };
  for (std::size_t k = 0; k < all.on_segments.size(); ++k) {
    LEFORT_TRY_VOID(turn_to_bone(model.segments[k], model.tissue.nodes_L, all.on_segments[k]));
    add(all.on_segments[k], std::int32_t(k));
  }
  if (model.stationary_bone)
    LEFORT_TRY_VOID(turn_to_bone(*model.stationary_bone, model.tissue.nodes_L, all.on_stationary));
  add(all.on_stationary, -1);
  add(all.on_planes, -1);
  return {};
}

/// \returns the stiffness of the supports that have none of their own [N/mm]; 0 if there are none.
double support_stiffness_n_per_mm(const PreviewModel& preview) {
  const VectorX diagonal = preview.stiffness_n_per_mm.diagonal();
  double sum = 0.0;
  std::size_t count = 0;
  for (const PreviewModel::Support& support : preview.supports) {
    if (support.n_per_mm > 0.0) continue;
    sum += diagonal.segment<3>(support.row).mean();
    ++count;
  }
  return count == 0 ? 0.0 : kSupportStiffness * sum / double(count);
}

}  // namespace

Result<PreviewModel> make_preview_model(const FaceModel& model,
                                        const geometry::TriangleMesh& skin_L,
                                        const TissueOptions& options,
                                        const BoundaryOptions& boundary, const Vec3& spacing_mm) {
  const mesh::VolumeMesh& tissue = model.tissue;
  const std::vector<std::int32_t>& fixed = tissue.node_sets.at(sets::kFixed);
  const bool is_elevated_only = nodes_painted(tissue, BoundaryLabel::kContact).empty() &&
                                !nodes_painted(tissue, BoundaryLabel::kElevated).empty();
  if (boundary.interface != TissueInterface::kClinical && !is_elevated_only &&
      tissue.face_sets.contains(sets::kStationaryContact))
    return fail(ErrorCode::kPlanInvalid,
                "boundary.labels: the preview does not support tissue painted as contact");
  if (nodes_on_segment(tissue).empty() && nodes_with_segment(tissue, boundary.interface).empty())
    return fail(ErrorCode::kAnatomyMissing, "no soft tissue lies on the segment");
  if (fixed.empty())
    return fail(ErrorCode::kAnatomyMissing, "the soft tissue is not fixed anywhere");
  LEFORT_TRY(const fem::RegionMaterials materials, materials_of(options));
  LEFORT_TRY(const auto elements, fem::make_element_terms(tissue, materials));
  std::vector<const fem::ForceTerm*> terms;
  terms.reserve(elements.size());
  for (const auto& term : elements) terms.push_back(term.get());
  LEFORT_TRY(fem::DofMap dofs, fem::DofMap::build(tissue.node_count(), fem::prescribe_zero(fixed)));
  const fem::Assembler assembler(tissue.nodes_L, std::move(dofs), terms);

  PreviewModel preview;
  preview.segment_count = std::int32_t(model.segments.size());
  preview.stiffness_n_per_mm = assembler.tangent(VectorX::Zero(3 * tissue.node_count()));
  for (Index node = 0; node < tissue.node_count(); ++node)
    preview.first_row.push_back(assembler.dofs().free_number(3 * node));
  LEFORT_TRY(preview.supports, find_supports(model, preview.first_row, boundary.interface));
  LEFORT_TRY_VOID(
      add_interface_supports(model, options, boundary, preview.first_row, preview.supports));
  preview.support_n_per_mm = support_stiffness_n_per_mm(preview);
  if (std::none_of(preview.supports.begin(), preview.supports.end(), [](const auto& support) {
        return support.segment >= 0 && support.motion_fraction == 1.0;  // The rest are planes.
      }))
    return fail(ErrorCode::kAnatomyMissing,
                "the segment's field has no direction out of the bone where tissue lies on it");
  preview.skin = embed_skin(skin_L, tissue, embedding_distance_mm(options, spacing_mm));
  return preview;
}

struct FacePreview::Solver {
  explicit Solver(PreviewModel preview) : model(std::move(preview)) {}

  PreviewModel model;
  std::mutex mutex;
  linear::LinearSolver solver{{.kind = linear::LinearSolverKind::kReusedFactor}};
  bool is_factorized = false;

  [[nodiscard]] double stiffness_of(const PreviewModel::Support& support) const {
    return support.n_per_mm > 0.0 ? support.n_per_mm : model.support_n_per_mm;
  }
  /// Of the tissue with the active supports.
  [[nodiscard]] linear::SparseMatrix stiffness(const std::vector<char>& active) const;
  [[nodiscard]] Result<VectorX> solve(const std::vector<char>& active,
                                      const std::vector<double>& pushed_mm);
};

linear::SparseMatrix FacePreview::Solver::stiffness(const std::vector<char>& active) const {
  linear::SparseMatrix K = model.stiffness_n_per_mm;
  for (std::size_t s = 0; s < active.size(); ++s) {
    if (!active[s]) continue;
    const PreviewModel::Support& support = model.supports[s];
    const Vec3& n = support.direction_L;
    const Index row = support.row;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j <= i; ++j)
        K.coeffRef(row + i, row + j) += stiffness_of(support) * n[i] * n[j];
  }
  return K;
}

Result<VectorX> FacePreview::Solver::solve(const std::vector<char>& active,
                                           const std::vector<double>& pushed_mm) {
  VectorX push_n = VectorX::Zero(model.stiffness_n_per_mm.rows());
  for (std::size_t s = 0; s < active.size(); ++s)
    if (active[s])
      push_n.segment<3>(model.supports[s].row) +=
          stiffness_of(model.supports[s]) * pushed_mm[s] * model.supports[s].direction_L;
  if (const auto done = solver.factorize(stiffness(active));
      done != linear::LinearSolveStatus::kDone)
    return tl::unexpected(describe(done));
  auto u = solver.solve(push_n, kTolerance);
  if (!u) return tl::unexpected(describe(u.error()));
  return *std::move(u);
}

FacePreview::FacePreview(PreviewModel model)
    : solver_(std::make_unique<Solver>(std::move(model))) {}
FacePreview::~FacePreview() = default;
FacePreview::FacePreview(FacePreview&&) noexcept = default;
FacePreview& FacePreview::operator=(FacePreview&&) noexcept = default;

Index FacePreview::vertex_count() const {
  return Index(solver_->model.skin.embedded_vertices.size());
}

std::size_t FacePreview::segment_count() const { return std::size_t(solver_->model.segment_count); }

Result<std::vector<Vec3>> FacePreview::displacement_mm(std::span<const RigidTransform> X_LB) const {
  Solver& system = *solver_;
  const PreviewModel& model = system.model;
  LEFORT_CHECK(X_LB.size() == segment_count());
  const std::scoped_lock lock(system.mutex);
  const std::size_t count = model.supports.size();
  if (!system.is_factorized) {  // With all supports: close to every set of them.
    const auto done = system.solver.factorize(system.stiffness(std::vector<char>(count, 1)));
    if (done != linear::LinearSolveStatus::kDone) return tl::unexpected(describe(done));
    system.is_factorized = true;
  }
  std::vector<double> pushed_mm(count, 0.0);
  std::vector<char> active(count, 1);
  bool is_at_rest = true;
  for (std::size_t s = 0; s < count; ++s) {
    const Vec3& p = model.supports[s].point_L;
    const std::int32_t segment = model.supports[s].segment;
    if (segment >= 0)
      pushed_mm[s] = model.supports[s].motion_fraction *
                     model.supports[s].direction_L.dot(X_LB[std::size_t(segment)] * p - p);
    is_at_rest = is_at_rest && std::abs(pushed_mm[s]) < kAtRest_mm;
    active[s] = model.supports[s].is_bilateral || pushed_mm[s] > 0.0;
  }
  VectorX u = VectorX::Zero(model.stiffness_n_per_mm.rows());
  for (int round = 0; round < kMaxRounds && !is_at_rest; ++round) {
    LEFORT_TRY(u, system.solve(active, pushed_mm));
    std::size_t changed = 0;
    for (std::size_t s = 0; s < count; ++s) {
      const PreviewModel::Support& support = model.supports[s];
      const char is_active =
          support.is_bilateral || pushed_mm[s] > support.direction_L.dot(u.segment<3>(support.row));
      changed += is_active != active[s];
      active[s] = is_active;
    }
    if (changed <= count / kSupportsPerChange) break;
  }
  std::vector<Vec3> nodes_mm(model.first_row.size(), Vec3::Zero());
  for (std::size_t node = 0; node < nodes_mm.size(); ++node)
    if (model.first_row[node] >= 0) nodes_mm[node] = u.segment<3>(model.first_row[node]);
  return skin_displacement(model.skin, nodes_mm);
}

}  // namespace lefort::predict
