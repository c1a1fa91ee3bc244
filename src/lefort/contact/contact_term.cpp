#include <lefort/contact/contact_term.h>
#include <lefort/contact/rest_gap.h>
#include <lefort/core/check.h>
#include <lefort/core/parallel.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace lefort::contact {
namespace {

/// Largest fraction of the contact area that may tunnel in one increment. A bone that jumps through
/// a face takes whole faces with it (test RejectsAStateInWhichAPlateHasJumpedThrough); over thin
/// edges of a real skull far less tunnels (study "contact on a real head").
constexpr double kMaxTunneledFraction = 0.02;

/// Gaps at the points of a rule.
struct RuleGaps {
  std::array<Vec3, kMaxPoints> p_L;
  std::array<Gap, kMaxPoints> gaps;

  RuleGaps(const RigidObstacle& obstacle, const FaceQuadrature& rule, std::span<const Vec3> x_L,
           Derivatives derivatives) {
    const std::size_t count = rule.points.size();
    for (std::size_t q = 0; q < count; ++q) p_L[q] = interpolate(rule.points[q], x_L);
    measure_gaps(obstacle, std::span(p_L).first(count), derivatives, std::span(gaps).first(count));
  }
};

/// \param gap_mm  to a bone; whether another bone is closer.
bool is_closer_to_any(std::span<const RigidObstacle> obstacles, const Vec3& p_L, double gap_mm) {
  return std::any_of(obstacles.begin(), obstacles.end(), [&](const RigidObstacle& other) {
    const auto& query_B = other.bone_B ? other.bone_B : other.distance_query_B;
    return measure_gap({query_B, other.X_LB, nullptr}, p_L, Derivatives::kFirst).gap_mm < gap_mm;
  });
}

/// Adds residual and stiffness of one point to those of its patch.
void add_point(double area_mm2, std::span<const double> N, const PenaltyResponse& response,
               const Mat3& hessian_mpa_per_mm, fem::LocalEquations& local) {
  const auto nodes = Index(N.size());
  for (Index a = 0; a < nodes; ++a)
    local.residual_n.segment<3>(3 * a) += area_mm2 * N[std::size_t(a)] * response.gradient_mpa;
  if (!local.wants_stiffness()) return;
  for (Index a = 0; a < nodes; ++a)
    for (Index b = 0; b < nodes; ++b)
      local.stiffness_n_per_mm.block<3, 3>(3 * a, 3 * b) +=
          area_mm2 * N[std::size_t(a)] * N[std::size_t(b)] * hessian_mpa_per_mm;
}

}  // namespace

ContactTerm::ContactTerm(std::span<const Vec3> nodes_L, std::vector<mesh::Face> faces,
                         RigidObstacle obstacle, const Options& options,
                         std::span<const RigidObstacle> other_obstacles)
    : name_(options.name),
      obstacle_(std::move(obstacle)),
      stiffness_mpa_per_mm_(options.stiffness_mpa_per_mm),
      penetration_tolerance_mm_(options.penetration_tolerance_mm),
      surface_(nodes_L, faces, options.integration),
      rest_gaps_mm_(surface_.point_count(), 0.0),
      bone_rest_gaps_mm_(surface_.point_count(), 0.0),
      history_(surface_.point_count(), options.penetration_tolerance_mm.has_value()),
      clearance_(surface_.patches().size()) {
  LEFORT_CHECK(obstacle_.distance_query_B != nullptr);
  LEFORT_CHECK(stiffness_mpa_per_mm_ > 0.0 && options.contact_snap_mm >= 0.0);
  LEFORT_CHECK(options.penetration_tolerance_mm.value_or(1.0) > 0.0);
  LEFORT_CHECK(options.contact_snap_mm < obstacle_.distance_query_B->max_distance_mm());
  for (std::size_t patch = 0; patch < surface_.patches().size(); ++patch)
    for_each_point(patch, nodes_L, [&](const PointGap& at) {
      const Gap to_bone = gap_to_bone(obstacle_, at.p_L, at.measured);
      const bool is_on_other = is_closer_to_any(other_obstacles, at.p_L, to_bone.gap_mm);
      const double snap_mm = is_on_other ? 0.0 : options.contact_snap_mm;
      rest_gaps_mm_[at.number] = rest_gap_mm(at.measured, to_bone, snap_mm);
      bone_rest_gaps_mm_[at.number] = bone_rest_gap_mm(to_bone, snap_mm);
      rest_penetration_mm_ = std::max(rest_penetration_mm_, -to_bone.gap_mm);
      history_.set_reference(at.number, contact_reference(obstacle_, at.p_L, at.measured));
    });
  note_clearances(nodes_L);
}

template <class Function>
void ContactTerm::for_each_point(std::size_t patch, std::span<const Vec3> x_L,
                                 const Function& f) const {
  const ContactPatch& of = surface_.patch(patch);
  const PatchPositions x(of.span(), x_L);
  const FaceQuadrature& rule = face_quadrature(of.rule);
  const RuleGaps at(obstacle_, rule, x.span(), Derivatives::kFirst);
  for (std::size_t q = 0; q < rule.points.size(); ++q) {
    const std::size_t number = of.first_point + q;
    f(PointGap{.number = number,
               .N = std::span(rule.points[q].N).first(of.count),
               .p_L = at.p_L[q],
               .measured = at.gaps[q],
               .acting = history_.acting_gap(number, obstacle_, at.p_L[q], at.gaps[q])});
  }
}

double ContactTerm::pressure_at(const PointGap& at) const {
  if (at.acting.zone != field::Zone::kBand) return 0.0;
  return pressure_mpa(rest_gaps_mm_[at.number] - at.acting.gap_mm,
                      history_.penalty(at.number, stiffness_mpa_per_mm_));
}

PointContact ContactTerm::contact_at(const PointGap& at) const {
  const double gap_mm = std::min(at.acting.gap_mm, at.measured.gap_mm);
  return {.area_mm2 = surface_.area_mm2(at.number),
          .pressure_mpa = pressure_at(at),
          .gradient_L = at.acting.gradient_L,
          .gap_mm = gap_mm,
          .depth_mm = rest_gaps_mm_[at.number] - gap_mm,
          .bone_depth_mm =
              bone_depth_mm(obstacle_, at.p_L, at.measured, bone_rest_gaps_mm_[at.number])};
}

void ContactTerm::commit(std::span<const Vec3> x_L) {
  history_.add_tunneled_area_mm2(
      deterministic_sum(Index(surface_.patches().size()), 0.0, [&](Index item) {
        double tunneled_mm2 = 0.0;
        for_each_point(std::size_t(item), x_L, [&](const PointGap& at) {
          if (history_.commit(at.number, obstacle_, at.p_L, at.measured))
            tunneled_mm2 += surface_.area_mm2(at.number);
        });
        return tunneled_mm2;
      }));
  note_clearances(x_L);
}

void ContactTerm::rollback() { history_.rollback(); }

void ContactTerm::begin_step() { history_.begin_step(); }

Index ContactTerm::activate_tangent_planes(std::span<const Vec3> x_L) {
  if (!history_.uses_tangent_planes()) return 0;
  return deterministic_sum(Index(surface_.patches().size()), Index(0), [&](Index item) {
    Index activated = 0;
    for_each_point(std::size_t(item), x_L, [&](const PointGap& at) {
      if (!history_.activate_tangent_plane(at.number, obstacle_, at.p_L, at.measured)) return;
      clearance_.reset(std::size_t(item));
      ++activated;
    });
    return activated;
  });
}

void ContactTerm::update_multipliers(std::span<const Vec3> x_L) {
  parallel_for(Index(surface_.patches().size()), [&](Index item) {
    for_each_point(std::size_t(item), x_L, [&](const PointGap& at) {
      const double depth_mm = rest_gaps_mm_[at.number] - at.acting.gap_mm;
      const bool has_multiplier = history_.update_multiplier(
          at.number, pressure_at(at), depth_mm, penetration_tolerance_mm_.value_or(0.0));
      // A multiplier acts at gaps beyond the clearance, too.
      if (has_multiplier) clearance_.reset(std::size_t(item));
    });
  });
}

void ContactTerm::note_clearances(std::span<const Vec3> x_L) {
  const double max_distance_mm = obstacle_.distance_query_B->max_distance_mm();
  parallel_for(Index(surface_.patches().size()), [&](Index item) {
    const auto patch = std::size_t(item);
    double clearance_mm = max_distance_mm;
    for_each_point(patch, x_L, [&](const PointGap& at) {
      const bool has_distance =
          at.measured.zone == field::Zone::kBand || at.measured.zone == field::Zone::kOutside;
      const double contact_gap_mm = std::max(rest_gaps_mm_[at.number], 0.0);
      const bool may_be_clear = has_distance && history_.is_free(at.number);
      clearance_mm =
          std::min(clearance_mm, may_be_clear ? at.measured.gap_mm - contact_gap_mm : 0.0);
    });
    const PatchPositions x(surface_.patch(patch).span(), x_L);
    clearance_.record(patch, obstacle_, x.span(), clearance_mm);
  });
}

void ContactTerm::restore(const Checkpoint& checkpoint, std::span<const Vec3> x_L) {
  history_.restore(checkpoint);
  commit(x_L);
  history_.set_tunneled_area_mm2(checkpoint.tunneled_area_mm2);
}

std::optional<std::string> ContactTerm::rejection_reason(std::span<const Vec3> x_L) const {
  const double tunneled_mm2 = newly_tunneled_area_mm2(x_L);
  if (tunneled_mm2 == 0.0) return std::nullopt;
  const double touching_mm2 = summarize(x_L).area_mm2;
  if (tunneled_mm2 <= kMaxTunneledFraction * touching_mm2) return std::nullopt;
  return fmt::format(
      "{:.1f} of {:.1f} mm^2 of tissue in contact have tunneled through {} in one increment",
      tunneled_mm2, touching_mm2, name_);
}

double ContactTerm::newly_tunneled_area_mm2(std::span<const Vec3> x_L) const {
  return deterministic_sum(Index(surface_.patches().size()), 0.0, [&](Index item) {
    double tunneled_mm2 = 0.0;
    for_each_point(std::size_t(item), x_L, [&](const PointGap& at) {
      if (history_.has_tunneled(at.number, obstacle_, at.measured))
        tunneled_mm2 += surface_.area_mm2(at.number);
    });
    return tunneled_mm2;
  });
}

bool ContactTerm::evaluate(Index item, std::span<const Vec3> x_L,
                           fem::LocalEquations& local) const {
  const ContactPatch& patch = surface_.patch(std::size_t(item));
  const FaceQuadrature& rule = face_quadrature(patch.rule);
  if (clearance_.is_out_of_range(std::size_t(item), obstacle_, x_L, rule.displacement_bound))
    return true;
  const RuleGaps measured(obstacle_, rule, x_L,
                          local.wants_stiffness() ? Derivatives::kSecond : Derivatives::kFirst);
  for (std::size_t q = 0; q < rule.points.size(); ++q) {
    const std::size_t number = patch.first_point + q;
    const field::Zone zone = measured.gaps[q].zone;
    if (zone == field::Zone::kInside) return false;
    if (zone == field::Zone::kUnknown && history_.is_side_known(number)) return false;

    const Gap gap = history_.acting_gap(number, obstacle_, measured.p_L[q], measured.gaps[q]);
    const double area_mm2 = surface_.area_mm2(number);
    const double depth_mm = rest_gaps_mm_[number] - gap.gap_mm;
    const PenaltyParameters penalty = history_.penalty(number, stiffness_mpa_per_mm_);
    const PenaltyResponse response =
        penalty_response(depth_mm, gap.gradient_L, gap.hessian_L, penalty);
    local.energy_mj += area_mm2 * response.energy_mj_per_mm2;
    if (gap.zone != field::Zone::kBand || !(pressure_mpa(depth_mm, penalty) > 0.0)) continue;

    ++local.contacts;
    local.deepest_mm = std::max(local.deepest_mm, depth_mm);
    const bool is_projected = local.wants_stiffness() && local.tangent != fem::Tangent::kExact;
    const Mat3 hessian_mpa_per_mm =
        is_projected ? psd_projected_hessian(depth_mm, gap.gradient_L, gap.hessian_L, penalty)
                     : response.hessian_mpa_per_mm;
    add_point(area_mm2, std::span(rule.points[q].N).first(x_L.size()), response, hessian_mpa_per_mm,
              local);
  }
  return true;
}

std::string ContactTerm::inadmissible_cause() const {
  return fmt::format(
      "tissue lies deeper in {} than its distance field reaches, {:.2f} mm "
      "(field.band_mm)",
      name_, obstacle_.distance_query_B->max_distance_mm());
}

ContactStatistics ContactTerm::summarize(std::span<const Vec3> x_L) const {
  ContactStatisticsSum sum;
  for (std::size_t patch = 0; patch < surface_.patches().size(); ++patch)
    for_each_point(patch, x_L, [&](const PointGap& at) {
      sum.add(contact_at(at), surface_.patch(patch).span());
    });
  return std::move(sum).finish(history_.tunneled_area_mm2());
}

std::vector<ContactPoint> ContactTerm::contact_points(std::span<const Vec3> x_L) const {
  std::vector<ContactPoint> points;
  for (std::size_t patch = 0; patch < surface_.patches().size(); ++patch)
    for_each_point(patch, x_L, [&](const PointGap& at) {
      const Vec3 traction_mpa = pressure_at(at) * at.acting.gradient_L;
      if (traction_mpa.isZero(0.0)) return;
      points.push_back({.x_L = at.p_L,
                        .pressure_mpa = traction_mpa.norm(),
                        .force_n = surface_.area_mm2(at.number) * traction_mpa});
    });
  return points;
}

std::vector<NodalContact> ContactTerm::at_nodes(std::span<const Vec3> x_L) const {
  NodalContactSum sum;
  for (std::size_t patch = 0; patch < surface_.patches().size(); ++patch)
    for_each_point(patch, x_L, [&](const PointGap& at) {
      sum.add(contact_at(at), surface_.patch(patch).span(), at.N);
    });
  return std::move(sum).finish(obstacle_, x_L);
}

}  // namespace lefort::contact
