#include <lefort/core/parallel.h>
#include <lefort/fem/assemble.h>
#include <lefort/fem/boundary_conditions.h>
#include <lefort/fem/dof_map.h>
#include <lefort/fem/element_term.h>
#include <lefort/fem/linear_solver.h>
#include <lefort/predict/linear_response.h>
#include <lefort/predict/tissue_boundary.h>

#include <memory>

namespace lefort::predict {
namespace {

/// A preview shows tenths of millimetres.
constexpr double kTolerance = 1e-8;

/// The displacement of the segment's point X by the k-th of the twelve numbers.
Vec3 unit_motion(std::size_t k, const Vec3& from_centre_mm) {
  Vec3 u = Vec3::Zero();
  if (k < 3)
    u[Index(k)] = 1.0;
  else
    u[Index(k - 3) / 3] = from_centre_mm[Index(k - 3) % 3];
  return u;
}

Vec3 mean(std::span<const Vec3> nodes_L, std::span<const std::int32_t> of) {
  Vec3 sum = Vec3::Zero();
  for (const std::int32_t node : of) sum += nodes_L[std::size_t(node)];
  return of.empty() ? sum : Vec3(sum / double(of.size()));
}

Error describe(fem::Factorisation outcome) {
  if (outcome == fem::Factorisation::kOutOfMemory)
    return {ErrorCode::kOutOfMemory,
            "the preview's equations do not fit into memory: ask for a larger "
            "tissue.element_size_mm"};
  return {ErrorCode::kNotConverged, "the preview's equations cannot be solved"};
}

}  // namespace

Result<LinearResponse> solve_linear_response(const FaceModel& model, const TissueOptions& options,
                                             Progress& progress) {
  const mesh::VolumeMesh& tissue = model.tissue;
  const std::vector<std::int32_t> on_segment = nodes_on_segment(tissue);
  const std::vector<std::int32_t>& fixed = tissue.node_sets.at(sets::kFixed);
  if (on_segment.empty())
    return fail(ErrorCode::kAnatomyMissing, "no soft tissue lies on the segment");
  if (fixed.empty()) return fail(ErrorCode::kAnatomyMissing, "nothing holds the soft tissue");
  LEFORT_TRY(const fem::NeoHookean material,
             fem::NeoHookean::from_young_poisson(options.young_mpa, options.poisson));
  LEFORT_TRY(const auto elements, fem::make_element_terms(tissue, {{0, material}}));
  std::vector<const fem::ForceTerm*> terms;
  for (const auto& term : elements) terms.push_back(term.get());

  auto held = fem::fix(fixed);
  const auto moved = fem::fix(on_segment);
  held.insert(held.end(), moved.begin(), moved.end());
  LEFORT_TRY(fem::DofMap dofs, fem::DofMap::build(tissue.node_count(), held));
  const fem::Assembler assembler(tissue.nodes_L, std::move(dofs), terms);
  const VectorX rest = VectorX::Zero(3 * tissue.node_count());
  fem::LinearSolver solver;
  solver.describe(assembler.nodes_L(), assembler.dofs());
  if (const auto done = solver.factorise(assembler.tangent(rest));
      done != fem::Factorisation::kDone)
    return tl::unexpected(describe(done));

  LinearResponse response;
  response.centre_B = mean(tissue.nodes_L, on_segment);
  for (std::size_t k = 0; k < response.unit_mm.size(); ++k) {
    if (progress.stop_requested()) return fail(ErrorCode::kCancelled, "cancelled");
    VectorX u = rest;
    for (const std::int32_t node : on_segment)
      u.segment<3>(3 * Index(node)) =
          unit_motion(k, tissue.nodes_L[std::size_t(node)] - response.centre_B);
    const auto free =
        solver.solve(-assembler.dofs().free_part(assembler.tangent_times(rest, u)), kTolerance);
    if (!free) return tl::unexpected(describe(free.error()));
    u = assembler.dofs().with_free_part(u, *free);
    for (Index node = 0; node < tissue.node_count(); ++node)
      response.unit_mm[k].emplace_back(u.segment<3>(3 * node));
    progress.report(double(k + 1) / double(response.unit_mm.size()));
  }
  return response;
}

std::vector<Vec3> displacement_at(const LinearResponse& response, const RigidTransform& X_LB) {
  const Mat3 A = X_LB.linear() - Mat3::Identity();
  const Vec3 t = X_LB * response.centre_B - response.centre_B;
  std::array<double, 12> amount{t.x(), t.y(), t.z()};
  for (std::size_t k = 3; k < 12; ++k) amount[k] = A(Index(k - 3) / 3, Index(k - 3) % 3);
  std::vector<Vec3> u(response.unit_mm[0].size(), Vec3::Zero());
  parallel_for(Index(u.size()), [&](Index point) {
    for (std::size_t k = 0; k < 12; ++k)
      u[std::size_t(point)] += amount[k] * response.unit_mm[k][std::size_t(point)];
  });
  return u;
}

}  // namespace lefort::predict
