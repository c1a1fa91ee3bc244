#include <lefort/contact/contact_surface.h>
#include <lefort/contact/pose_derivative.h>
#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/fem/solve/equilibrium.h>
#include <lefort/fem/solve/load_steps.h>
#include <lefort/predict/face_response.h>
#include <lefort/predict/load_levels.h>
#include <lefort/predict/solver_settings.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace lefort::predict {
namespace {

/// Of iterative linear solvers, for derivatives.
constexpr double kDerivativeTolerance = 1e-10;

/// Paths without motion, for the checks of bones and queries.
std::vector<geometry::RigidPath> paths_at_rest(const std::vector<std::string>& names) {
  std::vector<geometry::RigidPath> paths;
  paths.reserve(names.size());
  for (const std::string& name : names)
    paths.push_back({.segment = name, .keyframes = {geometry::Keyframe{}}, .steps = 1});
  return paths;
}

Result<VectorX> as_result(tl::expected<VectorX, linear::LinearSolveStatus> solved) {
  if (solved) return *std::move(solved);
  if (solved.error() == linear::LinearSolveStatus::kOutOfMemory)
    return fail(ErrorCode::kOutOfMemory, "the tangent of the face does not fit into memory");
  return fail(ErrorCode::kNotConverged,
              "the derivatives of the face cannot be computed: its tangent is not positive "
              "definite, so that this equilibrium is not stable");
}

/// Numbers whose motion moves a segment, and its motion by each.
struct SegmentRates {
  std::vector<std::size_t> numbers;
  std::vector<geometry::MotionRate> rates;
};

SegmentRates rates_of_segment(std::span<const PoseRate> rates, std::size_t segment) {
  SegmentRates of;
  for (std::size_t n = 0; n < rates.size(); ++n)
    for (const auto& [k, rate] : rates[n])
      if (k == segment) {
        of.numbers.push_back(n);
        of.rates.push_back(rate);
      }
  return of;
}

/// Adds the derivatives of the items of a term, one after the other.
///
/// \param derivatives_of  returns those of an item at the positions of its nodes.
template <class Function>
void add_items(const fem::ForceTerm& term, std::span<const Vec3> x_L, const SegmentRates& rates,
               std::vector<VectorX>& sums, const Function& derivatives_of) {
  const Index count = term.item_count();
  std::vector<Eigen::MatrixXd> of_items(std::size_t(count), Eigen::MatrixXd{});
  parallel_for(count, [&](Index item) {
    const auto nodes = term.nodes(item);
    std::array<Vec3, fem::kMaxLocalNodes> x;
    for (std::size_t a = 0; a < nodes.size(); ++a) x[a] = x_L[std::size_t(nodes[a])];
    of_items[std::size_t(item)] = derivatives_of(item, std::span(x).first(nodes.size()));
  });
  for (Index item = 0; item < count; ++item) {
    const auto nodes = term.nodes(item);
    for (std::size_t n = 0; n < rates.numbers.size(); ++n)
      for (std::size_t a = 0; a < nodes.size(); ++a)
        sums[rates.numbers[n]].segment<3>(3 * Index(nodes[a])) +=
            of_items[std::size_t(item)].block<3, 1>(3 * Index(a), Index(n));
  }
}

}  // namespace

std::vector<Vec3> FaceState::displacement_mm() const {
  std::vector<Vec3> vectors(std::size_t(at.u.size() / 3));
  for (std::size_t n = 0; n < vectors.size(); ++n) vectors[n] = at.u.segment<3>(Index(3 * n));
  return vectors;
}

Result<std::unique_ptr<FaceResponse>> FaceResponse::create(
    const FaceModel& model, std::vector<std::string> names, const PredictionOptions& options,
    Progress& progress, const linear::LinearSolverOptions& linear) {
  LEFORT_CHECK(names.size() == model.segments.size());
  std::unique_ptr<FaceResponse> response(new FaceResponse(options, linear));
  LEFORT_TRY(const DistanceQueries distance_queries_B,
             bone_distance_queries(model.segments, options.contact.detection));
  LEFORT_TRY_VOID(check_query_range(paths_at_rest(names), model.segments, distance_queries_B,
                                    options.boundary));
  LEFORT_TRY(response->body_, FaceBody::create(model, std::move(names), distance_queries_B,
                                               response->options_, progress));
  double max_distance_mm = std::numeric_limits<double>::infinity();
  for (const auto& distance_query_B : distance_queries_B)
    max_distance_mm = std::min(max_distance_mm, distance_query_B->max_distance_mm());
  response->max_increment_mm_ =
      max_increment_mm(options.tissue, obstacle_of(model), max_distance_mm);
  for (const ContactBone& segment : model.segments) {
    const std::vector<Vec3>& vertices = segment.surface_B.vertices;
    Vec3 center = Vec3::Zero();
    for (const Vec3& vertex : vertices) center += vertex / double(vertices.size());
    double radius_mm = 0.0;
    for (const Vec3& vertex : vertices) radius_mm = std::max(radius_mm, (vertex - center).norm());
    response->centers_B_.push_back(center);
    response->radius_mm_.push_back(radius_mm);
  }
  return response;
}

FaceState FaceResponse::at_rest() const {
  const std::vector<RigidTransform> X_LB(segment_count(), RigidTransform::Identity());
  const FaceEquilibrium rest{X_LB, VectorX::Zero(3 * model().tissue.node_count())};
  return {rest};
}

int FaceResponse::increment_count(const std::vector<RigidTransform>& from_X_LB,
                                  const std::vector<RigidTransform>& to_X_LB) const {
  constexpr double kRoundOff = 1e-9;  // Of the number.
  double moved_mm = 0.0;
  for (std::size_t k = 0; k < to_X_LB.size(); ++k) {
    const Vec3 shift = to_X_LB[k] * centers_B_[k] - from_X_LB[k] * centers_B_[k];
    const Vec3 turn_rad =
        geometry::rotation_vector(to_X_LB[k].linear() * from_X_LB[k].linear().transpose());
    moved_mm = std::max(moved_mm, shift.norm() + radius_mm_[k] * turn_rad.norm());
  }
  return int(std::max(std::ceil(moved_mm / max_increment_mm_ - kRoundOff), 1.0));
}

std::vector<RigidTransform> FaceResponse::between(const std::vector<RigidTransform>& from_X_LB,
                                                  const std::vector<RigidTransform>& to_X_LB,
                                                  double fraction) const {
  if (fraction == 1.0) return to_X_LB;
  std::vector<RigidTransform> poses;
  for (std::size_t k = 0; k < to_X_LB.size(); ++k)
    poses.push_back(geometry::interpolate_pose(from_X_LB[k], to_X_LB[k], fraction, centers_B_[k]));
  return poses;
}

Result<FaceState> FaceResponse::solve(const std::vector<RigidTransform>& X_LB,
                                      const FaceState& start, Progress& progress) {
  LEFORT_CHECK(X_LB.size() == segment_count() && start.at.X_LB.size() == segment_count());
  for (const RigidTransform& pose : X_LB)
    if (!pose.matrix().allFinite())
      return fail(ErrorCode::kInvalidArgument, "the pose of a segment is not finite");
  body_->set_poses(start.at.X_LB);
  // A solver that is iterative for its size starts without the state of earlier solves; a reused
  // factor below that size stays.
  if (body_->assembler().dofs().free_count() > linear_.direct_rows)
    linear_solver_ = linear::LinearSolver(linear_);
  FaceEquilibrium last = start.at;
  fem::LoadStepper stepper(
      fem::LoadState{0.0, start.at.u},
      [&](double fraction, const VectorX& guess) {
        std::vector<RigidTransform> poses = between(start.at.X_LB, X_LB, fraction);
        fem::NewtonOutcome outcome = body_->solve(last, poses, guess, linear_solver_, progress);
        newton_iterations_ += outcome.iterations();
        if (outcome.converged()) last = {std::move(poses), outcome.x, last.u};
        return outcome;
      },
      load_step_options(options_.solver, 1.0 / increment_count(start.at.X_LB, X_LB)));
  LEFORT_TRY_VOID(stepper.advance_to(1.0, progress));
  return FaceState{std::move(last)};
}

Result<FaceState> FaceResponse::solve_near(const std::vector<RigidTransform>& X_LB,
                                           const FaceState& start, const FaceState& near) {
  for (const RigidTransform& pose : X_LB)
    if (!pose.matrix().allFinite()) return solve(X_LB, start);
  if (increment_count(near.at.X_LB, X_LB) > 1) return solve(X_LB, start);
  const fem::NewtonOutcome outcome =
      body_->solve(start.at, X_LB, near.at.u, linear_solver_, Progress::none());
  newton_iterations_ += outcome.iterations();
  if (outcome.converged()) return FaceState{{X_LB, outcome.x, start.at.u}};
  return solve(X_LB, start);
}

Result<FaceState> FaceResponse::approach(const std::vector<RigidTransform>& X_LB,
                                         const FaceState& start, int iterations) {
  LEFORT_CHECK(X_LB.size() == segment_count() && start.at.X_LB.size() == segment_count());
  for (const RigidTransform& pose : X_LB)
    if (!pose.matrix().allFinite()) return solve(X_LB, start);
  constexpr int kMaxIncrements = 3;
  const int count = increment_count(start.at.X_LB, X_LB);
  if (count > kMaxIncrements) return solve(X_LB, start);
  FaceState state = start;
  for (int n = 1; n <= count; ++n) {
    const std::vector<RigidTransform> poses = between(start.at.X_LB, X_LB, double(n) / count);
    const fem::NewtonOutcome outcome =
        body_->approach(poses, state.at.u, iterations, linear_solver_);
    newton_iterations_ += outcome.iterations();
    if (!outcome.converged() && outcome.stop != fem::NewtonStop::kTooManyIterations)
      return solve(X_LB, start);
    state.at = {poses, outcome.x, state.at.u};
  }
  return state;
}

Result<void> FaceResponse::factorize_at(const FaceState& state) {
  if (body_->weighted_contacts().any())
    return fail(ErrorCode::kInvalidArgument,
                "derivatives of the face need contact.integration quadrature, not weighted");
  body_->set_equilibrium(state.at);
  const fem::Assembler& assembler = body_->assembler();
  for (const contact::ContactTerm& contact : body_->segment_contacts())
    if (!contact.is_conservative(assembler.dofs()))
      return fail(ErrorCode::kInvalidArgument,
                  "derivatives of the face need contact.detection smooth or trilinear, not bvh");
  fem::set_near_null_space(tangent_solver_, assembler);
  const linear::LinearSolveStatus status = tangent_solver_.factorize(assembler.tangent(state.at.u));
  if (status == linear::LinearSolveStatus::kDone) return {};
  LEFORT_TRY_VOID(as_result(tl::unexpected(status)));
  return {};
}

Result<VectorX> FaceResponse::solve_linear(const VectorX& b) {
  return as_result(tangent_solver_.solve(b, kDerivativeTolerance));
}

VectorX FaceResponse::prescribed_rate(const FaceState& state, const PoseRate& rate) const {
  const std::vector<Vec3>& nodes_L = model().tissue.nodes_L;
  VectorX du = VectorX::Zero(state.at.u.size());
  for (const auto& [k, motion] : rate)
    for (const std::int32_t node : body_->bonded()[k])
      du.segment<3>(3 * Index(node)) = motion.at(state.at.X_LB[k] * nodes_L[std::size_t(node)]);
  return du;
}

std::vector<VectorX> FaceResponse::explicit_rates(const FaceState& state,
                                                  std::span<const PoseRate> rates) const {
  const std::vector<Vec3> x_L = contact::displaced(model().tissue.nodes_L, state.at.u);
  std::vector<VectorX> sums(rates.size(), VectorX::Zero(state.at.u.size()));
  for (std::size_t k = 0; k < segment_count(); ++k) {
    const SegmentRates of = rates_of_segment(rates, k);
    if (of.numbers.empty()) continue;
    if (k < body_->segment_contacts().size()) {
      const contact::ContactTerm& contact = body_->segment_contacts()[k];
      add_items(contact, x_L, of, sums, [&](Index item, std::span<const Vec3> x) {
        return contact::pose_derivatives_n(contact, item, x, of.rates);
      });
    }
    const contact::SupportTerm& supports = body_->segment_supports()[k];
    add_items(supports, x_L, of, sums, [&](Index item, std::span<const Vec3> x) {
      const double fraction = body_->motion_fractions()[k][std::size_t(item)];
      if (fraction == 1.0) return contact::pose_derivatives_n(supports, item, x, of.rates);
      const Vec3& rest = model().tissue.nodes_L[std::size_t(supports.nodes(item)[0])];
      return contact::following_derivatives_n(supports, item, x, of.rates, fraction,
                                              state.at.X_LB[k] * rest);
    });
  }
  return sums;
}

Result<Eigen::MatrixXd> FaceResponse::sensitivities(const FaceState& state,
                                                    std::span<const PoseRate> rates) {
  LEFORT_TRY_VOID(factorize_at(state));
  const fem::Assembler& assembler = body_->assembler();
  const std::vector<VectorX> dr = explicit_rates(state, rates);
  Eigen::MatrixXd du(state.at.u.size(), Index(rates.size()));
  for (std::size_t n = 0; n < rates.size(); ++n) {
    const VectorX du_p = prescribed_rate(state, rates[n]);
    const VectorX b = assembler.dofs().free_part(assembler.tangent_times(state.at.u, du_p) + dr[n]);
    LEFORT_TRY(const VectorX du_f, solve_linear(-b));
    du.col(Index(n)) = assembler.dofs().with_free_part(du_p, du_f);
  }
  return du;
}

Result<VectorX> FaceResponse::gradient(const FaceState& state, const VectorX& dJ_du,
                                       std::span<const PoseRate> rates) {
  LEFORT_CHECK(dJ_du.size() == state.at.u.size());
  LEFORT_TRY_VOID(factorize_at(state));
  const fem::Assembler& assembler = body_->assembler();
  LEFORT_TRY(const VectorX adjoint, solve_linear(assembler.dofs().free_part(dJ_du)));
  const std::vector<VectorX> dr = explicit_rates(state, rates);
  VectorX dJ_dq{Index(rates.size())};
  for (std::size_t n = 0; n < rates.size(); ++n) {
    const VectorX du_p = prescribed_rate(state, rates[n]);
    const VectorX b = assembler.dofs().free_part(assembler.tangent_times(state.at.u, du_p) + dr[n]);
    dJ_dq[Index(n)] = dJ_du.dot(du_p) - adjoint.dot(b);
  }
  return dJ_dq;
}

}  // namespace lefort::predict
