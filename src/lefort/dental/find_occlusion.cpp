#include <lefort/core/decompositions.h>
#include <lefort/core/parallel.h>
#include <lefort/core/units.h>
#include <lefort/dental/check_arch.h>
#include <lefort/dental/faced_gap.h>
#include <lefort/dental/find_occlusion.h>
#include <lefort/dental/gap_grid.h>
#include <lefort/geometry/bvh.h>
#include <lefort/geometry/rigid_motion.h>
#include <lefort/geometry/transform_mesh.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace lefort::dental {
namespace {

using geometry::Bvh;
using geometry::TriangleMesh;
using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;

constexpr Index kMinFacing = 50;
/// Further away, the search has left the teeth of its start.
constexpr double kMaxMovement_mm = 12.0;
/// Gaps further than this are as wide as none in the fine stages.
constexpr double kFineReach_mm = 2.0;
/// Makes rotations comparable with translations: half the width of an arch.
constexpr double kArch_mm = 25.0;

/// A stage of the minimization: width of the weights, and penalty of penetration.
struct Stage {
  double width_mm = 0.0;
  double penalty = 1.0;
  int iterations = 0;
  bool slides = true;  ///< Whether the arch may move in the occlusal plane; otherwise it settles.
  /// Cost of the squared displacement from the start [mm^2], per area: a piece with few contacts
  /// would tilt (Tikhonov).
  double displacement = 0.0;
};
/// The lower arch settles on the upper teeth, then slides. Without penalty it would sink into them.
constexpr std::array<Stage, 3> kFirst{
    {{6.0, 10.0, 10, false}, {2.0, 25.0, 10, false}, {2.0, 1.0, 10}}};
constexpr std::array<Stage, 2> kCoarse{{{1.0, 4.0, 10}, {0.5, 10.0, 15}}};
constexpr std::array<Stage, 2> kFine{{{0.25, 40.0, 20}, {0.15, 300.0, 30}}};
constexpr double kPrior = 0.02;
/// For a piece that is close: from the gaps of its displacement.
constexpr std::array<Stage, 4> kClose{{{2.0, 1.0, 10, true, kPrior},
                                       {0.5, 10.0, 15, true, kPrior},
                                       {0.25, 40.0, 20, true, kPrior},
                                       {0.15, 300.0, 30, true, kPrior}}};

/// A point of an arch and the area around it.
struct ArchPoint {
  Vec3 point, normal;
  double mm2 = 0.0;
};

/// Every n-th vertex; the area of the others goes with it. Those that do not face `occlusal` within
/// 60 degrees are left out: they touch nothing.
std::vector<ArchPoint> points_of(const Bvh& arch, const Vec3& occlusal, Index maximum) {
  const TriangleMesh& mesh = arch.mesh();
  std::vector<double> mm2(mesh.vertices.size(), 0.0);
  for (Index t = 0; t < mesh.triangle_count(); ++t) {
    const Vec3& a = mesh.corner(t, 0);
    const double third = (mesh.corner(t, 1) - a).cross(mesh.corner(t, 2) - a).norm() / 6.0;
    for (const std::int32_t v : mesh.triangles[std::size_t(t)]) mm2[std::size_t(v)] += third;
  }
  const Index stride = std::max<Index>((mesh.vertex_count() + maximum - 1) / maximum, 1);
  std::vector<ArchPoint> points;
  for (Index v = 0; v < mesh.vertex_count(); v += stride) {
    const Vec3 normal = arch.pseudonormals().at_vertex(mesh, v);
    if (normal.dot(occlusal) > 0.5)
      points.push_back(
          {mesh.vertices[std::size_t(v)], normal, double(stride) * mm2[std::size_t(v)]});
  }
  return points;
}

std::vector<Vec3> positions_of(const std::vector<ArchPoint>& points) {
  std::vector<Vec3> positions;
  positions.reserve(points.size());
  for (const ArchPoint& at : points) positions.push_back(at.point);
  return positions;
}

/// Points of an arch and the gaps over it: on a grid, or exact.
struct SearchedArch {
  const Bvh* surface = nullptr;
  std::vector<ArchPoint> few, many;
  GapGrid grid;

  SearchedArch(const Bvh& arch, const Vec3& occlusal)
      : surface(&arch),
        few(points_of(arch, occlusal, 2000)),
        many(points_of(arch, occlusal, 6000)),
        grid(arch, positions_of(many)) {}

  [[nodiscard]] const std::vector<ArchPoint>& points(bool exact) const {
    return exact ? many : few;
  }
  [[nodiscard]] std::optional<FacedGap> gap(const Vec3& p, const Vec3& n, bool exact) const {
    return exact ? gap_over(*surface, p, n, kFineReach_mm) : grid.gap_over(p, n);
  }
};

/// A requested distance along a direction of a point of the lower arch.
struct Request {
  Vec3 point, direction;
  double level_mm = 0.0;  ///< Of the moved point along the direction.
  [[nodiscard]] double off_mm(const RigidTransform& X) const {
    return direction.dot(X * point) - level_mm;
  }
};

/// Both arches as the search sees them.
struct SearchedArches {
  SearchedArch upper, lower;
  Vec3 center_of_lower;
  ArchAxes axes;
  OcclusionRequests requests;
  double lower_mm2 = 0.0;  ///< Area of the points of the lower arch.
};

double area_of(const std::vector<ArchPoint>& points) {
  double mm2 = 0.0;
  for (const ArchPoint& at : points) mm2 += at.mm2;
  return mm2;
}

/// The requests while the lower arch is near `X`: overjet and overbite are those of the points that
/// are the edges there.
std::vector<Request> requests_at(const SearchedArches& arches, const RigidTransform& X) {
  const OcclusionRequests& wanted = arches.requests;
  const ArchAxes& axes = arches.axes;
  std::vector<Request> requests;
  if (wanted.midline_mm)
    requests.push_back({wanted.lower_midline_L, axes.left_L(),
                        *wanted.midline_mm + axes.left_L().dot(wanted.upper_midline_L)});
  if (!wanted.overjet_mm && !wanted.overbite_mm) return requests;
  const auto edges = incisal_edges(arches.upper.surface->mesh(),
                                   geometry::transformed(arches.lower.surface->mesh(), X), axes);
  if (!edges) return requests;
  const Vec3& upper = edges->upper_L;
  const Vec3 edge = X.inverse() * edges->lower_L;
  if (wanted.overjet_mm)
    requests.push_back({edge, -axes.anterior_L, *wanted.overjet_mm - axes.anterior_L.dot(upper)});
  if (wanted.overbite_mm)
    requests.push_back({edge, axes.superior_L, *wanted.overbite_mm + axes.superior_L.dot(upper)});
  return requests;
}

/// Cost of area: that of Geman and McClure for open gaps, the penalty for penetration. `weight` is
/// half its derivative over the gap.
struct GapCost {
  double cost = 0.0, weight = 0.0;
};

GapCost cost_of(double gap_mm, const Stage& stage) {
  const double g2 = gap_mm * gap_mm;
  if (gap_mm < 0.0) return {stage.penalty * g2, stage.penalty};
  const double w2 = stage.width_mm * stage.width_mm, r = w2 / (w2 + g2);
  return {r * g2, r * r};
}

/// Normal equations of one step of (rotation times kArch_mm, translation) of the lower arch.
struct GapSums {
  Mat6 matrix = Mat6::Zero();
  Vec6 vector = Vec6::Zero();
  double cost = 0.0;
  Index facing = 0;

  GapSums& operator+=(const GapSums& other) {
    matrix += other.matrix;
    vector += other.vector;
    cost += other.cost;
    facing += other.facing;
    return *this;
  }
};

/// Where the sums are taken: position of the lower arch and free rotations.
struct SumAt {
  const Stage* stage;
  RigidTransform X, back;
  Vec3 center;  ///< Of the rotation.
  /// Projections onto the rotations and translations that are free.
  Mat3 rotations = Mat3::Identity(), movements = Mat3::Identity();
};

/// The part of one point. Area that faces nothing costs what a wide gap costs, so that an arch does
/// not lower its cost by leaving the other one.
/// \param direction  of the change of the gap as `moved` moves.
GapSums sum_of(const SumAt& at, double mm2, const std::optional<FacedGap>& faced, const Vec3& moved,
               const Vec3& direction) {
  GapSums one;
  if (!faced) {
    one.cost = mm2 * at.stage->width_mm * at.stage->width_mm;
    return one;
  }
  const GapCost cost = cost_of(faced->gap_mm, *at.stage);
  Vec6 row;
  row << at.rotations * (moved - at.center).cross(direction) / kArch_mm, at.movements * direction;
  one.matrix = mm2 * cost.weight * row * row.transpose();
  one.vector = mm2 * cost.weight * faced->gap_mm * row;
  one.cost = mm2 * cost.cost;
  one.facing = 1;
  return one;
}

/// Adds the cost of a distance of `p` along a direction.
void add_distance(const SumAt& at, const Vec3& p, const Vec3& direction, double off_mm,
                  double weight, GapSums& sums) {
  Vec6 row;
  row << at.rotations * (p - at.center).cross(direction) / kArch_mm, at.movements * direction;
  sums.matrix += weight * row * row.transpose();
  sums.vector += weight * off_mm * row;
  sums.cost += weight * off_mm * off_mm;
}

/// Adds the cost of the displacement of a point of the lower arch from the start.
void add_displacement(const SumAt& at, const ArchPoint& point, const Vec3& p, GapSums& sums) {
  const double weight = at.stage->displacement * point.mm2;
  if (weight == 0.0) return;
  const Vec3 off = p - point.point;
  for (Index axis = 0; axis < 3; ++axis)
    add_distance(at, p, Vec3::Unit(axis), off[axis], weight, sums);
}

GapSums sum_gaps(const SearchedArches& arches, bool exact, const RigidTransform& X,
                 const Stage& stage, const std::vector<Request>& requests) {
  const auto& from_lower = arches.lower.points(exact);
  const auto& from_upper = arches.upper.points(exact);
  SumAt at{&stage, X, X.inverse(), X * arches.center_of_lower};
  if (!stage.slides) {
    at.movements = arches.axes.superior_L * arches.axes.superior_L.transpose();
    at.rotations -= at.movements;
  }
  const auto count = Index(from_lower.size());
  GapSums sums = deterministic_sum(count + Index(from_upper.size()), GapSums{}, [&](Index i) {
    if (i < count) {
      const ArchPoint& point = from_lower[std::size_t(i)];
      const Vec3 p = X * point.point;
      const auto faced = arches.upper.gap(p, X.linear() * point.normal, exact);
      GapSums one = sum_of(at, point.mm2, faced, p, faced ? faced->normal : Vec3(Vec3::Zero()));
      add_displacement(at, point, p, one);
      return one;
    }
    const ArchPoint& point = from_upper[std::size_t(i - count)];
    const auto faced =
        arches.lower.gap(at.back * point.point, at.back.linear() * point.normal, exact);
    if (!faced) return sum_of(at, point.mm2, faced, Vec3::Zero(), Vec3::Zero());
    return sum_of(at, point.mm2, faced, X * faced->point, -(X.linear() * faced->normal));
  });
  for (const Request& request : requests)
    add_distance(at, X * request.point, request.direction, request.off_mm(X), arches.lower_mm2,
                 sums);
  return sums;
}

/// The cost by which ends are compared.
double compared_cost(const SearchedArches& arches, bool exact, const RigidTransform& X) {
  constexpr Stage kCompared{1.5, 25.0, 0};  // By area within about this gap.
  return sum_gaps(arches, exact, X, kCompared, requests_at(arches, X)).cost;
}

/// Minimizes the cost of one stage by damped Gauss-Newton steps (\cite nocedal2006, section 10.3):
/// a step that does not lower the cost is taken back. \returns false if the arches do not face each
/// other.
bool minimize(const SearchedArches& arches, bool exact, const Stage& stage, RigidTransform& X) {
  constexpr double kMaxStep_mm = 2.0, kEnough_mm = 1e-4, kSmall = 1e-4, kMaxDamping = 1e4;
  const std::vector<Request> requests = requests_at(arches, X);
  GapSums at = sum_gaps(arches, exact, X, stage, requests);
  double damping = kSmall;
  for (int n = 0; n < stage.iterations; ++n) {
    if (at.facing < kMinFacing) return false;
    const Mat6 damped = at.matrix + damping * at.matrix.trace() / 6.0 * Mat6::Identity();
    Vec6 step = -damped.ldlt().solve(at.vector);
    if (!step.allFinite()) return false;
    if (step.norm() > kMaxStep_mm) step *= kMaxStep_mm / step.norm();
    const RigidTransform next = geometry::rigid_motion(step.tail<3>(), step.head<3>() / kArch_mm,
                                                       X * arches.center_of_lower) *
                                X;
    const GapSums there = sum_gaps(arches, exact, next, stage, requests);
    const bool is_better = there.cost < at.cost;
    if (is_better) {
      X = next;
      at = there;
    }
    damping *= is_better ? 0.3 : 10.0;
    if (step.norm() < kEnough_mm || damping > kMaxDamping) break;
  }
  return at.facing >= kMinFacing;
}

/// Minimizes in stages. \returns nothing if the arches do not face each other.
std::optional<RigidTransform> minimize(const SearchedArches& arches, bool exact, RigidTransform X,
                                       std::span<const Stage> stages) {
  for (const Stage& stage : stages)
    if (!minimize(arches, exact, stage, X)) return std::nullopt;
  return X;
}

/// Largest distance between two positions of the lower arch, at its middle and its ends.
double distance_between(const RigidTransform& a, const RigidTransform& b, const Vec3& center,
                        const ArchAxes& axes) {
  double max_mm = 0.0;
  for (const Vec3& arm : {Vec3(kArch_mm * axes.anterior_L), Vec3(kArch_mm * axes.left_L()),
                          Vec3(-kArch_mm * axes.left_L())})
    max_mm = std::max(max_mm, (a * (center + arm) - b * (center + arm)).norm());
  return max_mm;
}

/// In the occlusal plane, from the given position to where the requests hold.
Vec3 requested_shift(const SearchedArches& arches) {
  Vec3 shift = Vec3::Zero();
  for (const Request& request : requests_at(arches, RigidTransform::Identity()))
    if (std::abs(request.direction.dot(arches.axes.superior_L)) < 0.5)
      shift -= request.off_mm(RigidTransform::Identity()) * request.direction;
  constexpr double kMaxShift_mm = 6.0;  // Half of the way that the search may go.
  const double length = shift.norm();
  return length > kMaxShift_mm ? Vec3(kMaxShift_mm / length * shift) : shift;
}

std::vector<RigidTransform> starts_of(const SearchedArches& arches,
                                      const OcclusionOptions& options) {
  const ArchAxes& axes = arches.axes;
  const Vec3 requested = requested_shift(arches);
  const auto multiples = [](double spacing) {
    return spacing > 0.0 ? std::vector<double>{0.0, -1.0, 1.0, -2.0, 2.0}
                         : std::vector<double>{0.0};
  };
  std::vector<RigidTransform> starts;
  for (const double ahead : multiples(options.shift_mm))
    for (const double aside : multiples(options.shift_mm))
      for (const double yaw : multiples(options.yaw_deg))
        starts.push_back(geometry::rigid_motion(
            requested + options.shift_mm * (ahead * axes.anterior_L + aside * axes.left_L()),
            radians_from_degrees(yaw * options.yaw_deg) * axes.superior_L, arches.center_of_lower));
  return starts;
}

/// Ends of the first stages, each once.
Result<std::vector<RigidTransform>> first_ends(const SearchedArches& arches,
                                               const std::vector<RigidTransform>& starts,
                                               Progress& progress) {
  constexpr double kSame_mm = 0.5;
  const Vec3& center = arches.center_of_lower;
  std::vector<RigidTransform> ends;
  for (std::size_t n = 0; n < starts.size(); ++n) {
    if (progress.stop_requested()) return fail(ErrorCode::kCancelled, "the search was cancelled");
    progress.report(0.5 * double(n) / double(starts.size()));
    const auto end = minimize(arches, false, starts[n], kFirst);
    if (end && std::none_of(ends.begin(), ends.end(), [&](const RigidTransform& other) {
          return distance_between(*end, other, center, arches.axes) < kSame_mm;
        }))
      ends.push_back(*end);
  }
  return ends;
}

/// An end of the search.
struct SearchEnd {
  RigidTransform X = RigidTransform::Identity();
  double cost = 0.0;
};

/// The ends of the coarse search with the lowest costs, the lowest one first.
Result<std::vector<SearchEnd>> coarse_ends(const SearchedArches& arches,
                                           const OcclusionOptions& options, Progress& progress) {
  const ArchAxes& axes = arches.axes;
  constexpr double kSame_mm = 0.2;
  constexpr std::size_t kRefined = 4;
  const Vec3& center = arches.center_of_lower;
  LEFORT_TRY(const std::vector<RigidTransform> firsts,
             first_ends(arches, starts_of(arches, options), progress));
  std::vector<SearchEnd> ends, kept;
  for (std::size_t n = 0; n < firsts.size(); ++n) {
    if (progress.stop_requested()) return fail(ErrorCode::kCancelled, "the search was cancelled");
    progress.report(0.5 + 0.5 * double(n) / double(firsts.size()));
    const auto end = minimize(arches, false, firsts[n], kCoarse);
    if (end && distance_between(*end, RigidTransform::Identity(), center, axes) <= kMaxMovement_mm)
      ends.push_back({*end, compared_cost(arches, false, *end)});
  }
  std::stable_sort(ends.begin(), ends.end(),
                   [](const SearchEnd& a, const SearchEnd& b) { return a.cost < b.cost; });
  for (const SearchEnd& end : ends)
    if (kept.size() < kRefined &&
        std::none_of(kept.begin(), kept.end(), [&](const SearchEnd& other) {
          return distance_between(end.X, other.X, center, axes) < kSame_mm;
        }))
      kept.push_back(end);
  return kept;
}

/// Refines the best ends with exact gaps. \returns that with the lowest cost.
Result<RigidTransform> search(const SearchedArches& arches, const OcclusionOptions& options,
                              Progress& progress) {
  std::vector<SearchEnd> ends(1);
  if (!options.is_close) {
    LEFORT_TRY(ends, coarse_ends(arches, options, progress));
  }
  progress.begin_stage("refine the occlusion");
  std::optional<RigidTransform> best;
  double best_cost = std::numeric_limits<double>::infinity();
  for (const SearchEnd& end : ends) {
    if (progress.stop_requested()) return fail(ErrorCode::kCancelled, "the search was cancelled");
    const auto refined = options.is_close ? minimize(arches, true, end.X, kClose)
                                          : minimize(arches, true, end.X, kFine);
    if (!refined) continue;
    const double cost = compared_cost(arches, true, *refined);
    if (cost >= best_cost) continue;
    best_cost = cost;
    best = refined;
  }
  if (best) return *best;
  return fail(
      ErrorCode::kNotConverged,
      fmt::format("no occlusion was found within {:g} mm: move the lower arch closer to it, "
                  "the arches must face each other",
                  kMaxMovement_mm));
}

/// Opens the arches along the superior direction until the penetration is within its limit.
RigidTransform without_penetration(const Arches& arches, RigidTransform X, const ArchAxes& axes,
                                   double reach_mm) {
  constexpr int kSteps = 20;
  for (int n = 0; n < kSteps; ++n) {
    const double deep_mm = max_penetration_mm(arches, X, reach_mm);
    if (deep_mm <= kMaxOcclusalPenetration_mm) break;
    X.translation() -= (deep_mm - 0.9 * kMaxOcclusalPenetration_mm) * axes.superior_L;
  }
  return X;
}

Result<void> check(const OcclusionRequests& requests) {
  for (const auto& [value, name] :
       {std::pair(requests.overjet_mm, "overjet"), std::pair(requests.overbite_mm, "overbite"),
        std::pair(requests.midline_mm, "midline")})
    if (value && !(std::abs(*value) <= kMaxRequest_mm))
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("the requested {} is {} mm, must be {:g} to {:g}", name, *value,
                              -kMaxRequest_mm, kMaxRequest_mm));
  return {};
}

}  // namespace

Result<Occlusion> find_occlusion(const TriangleMesh& upper_L, const TriangleMesh& lower_L,
                                 const ArchAxes& axes, const OcclusionOptions& options,
                                 Progress& progress) {
  LEFORT_TRY_VOID(check_arch(upper_L, "upper", -axes.superior_L));
  LEFORT_TRY_VOID(check_arch(lower_L, "lower", axes.superior_L));
  LEFORT_TRY_VOID(check(options.requests));
  if (!(options.shift_mm >= 0.0 && options.shift_mm <= 5.0) ||
      !(options.yaw_deg >= 0.0 && options.yaw_deg <= 10.0))
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("the spacing of the starts is {} mm and {} degrees, must be 0 to 5 and 0 to 10",
                    options.shift_mm, options.yaw_deg));
  progress.begin_stage("search the occlusion");
  const Arches arches{Bvh(upper_L), Bvh(lower_L)};
  SearchedArches searched{SearchedArch(arches.upper, -axes.superior_L),
                          SearchedArch(arches.lower, axes.superior_L),
                          mean_vertex(lower_L),
                          axes,
                          options.requests,
                          0.0};
  searched.lower_mm2 = area_of(searched.lower.few);
  const OcclusionRequests& wanted = options.requests;
  if ((wanted.overjet_mm || wanted.overbite_mm) && !incisal_edges(upper_L, lower_L, axes))
    return fail(ErrorCode::kInvalidArgument,
                "overjet and overbite are requested, but there are no opposite incisors");
  LEFORT_TRY(const RigidTransform closed, search(searched, options, progress));
  const double reach_mm = options.is_close ? kPieceReach_mm : kArchReach_mm;
  Occlusion found = measure_occlusion(arches, without_penetration(arches, closed, axes, reach_mm),
                                      axes, reach_mm);
  const OcclusalContacts& contacts = found.contacts;
  if (contacts.max_penetration_mm > kMaxOcclusalPenetration_mm)
    return fail(ErrorCode::kNotConverged,
                fmt::format("the arches cannot touch without penetration: {:.2f} mm deep, must be "
                            "{:g} or less; are the surfaces in the same frame?",
                            contacts.max_penetration_mm, kMaxOcclusalPenetration_mm));
  if (contacts.left_mm2 + contacts.right_mm2 <= 0.0)
    return fail(ErrorCode::kNotConverged,
                fmt::format("the arches do not touch where no vertex penetrates by more than {:g} "
                            "mm: their surfaces overlap elsewhere; crop gingiva behind the teeth",
                            kMaxOcclusalPenetration_mm));
  return found;
}

}  // namespace lefort::dental
