#include <lefort/dental/guide_holes.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace lefort::dental {
namespace {

using geometry::TriangleMesh;

/// A point of the bone where a hole may be.
struct Candidate {
  Vec3 point_L, axis_L;
  double position_mm = 0.0;  ///< Along the line.
  double from_cut_mm = 0.0;  ///< Positive, from the cut or the kerf.
  bool is_on_segment = false;
};

/// The guide must surround a hole by this.
constexpr double kRim_mm = 1.5;
constexpr double kNormalRadius_mm = 1.5;
/// Holes may be so much closer to the cut or further from it than wanted.
constexpr double kTolerance_mm = 2.0;

/// Vertices of the bone that the guide may cover.
std::vector<Index> vertices_near(const GuideSite& site, const CutLine& line, double reach_mm) {
  Box3 box;
  for (const Vec3& p_L : line.points_L) box.extend(p_L);
  const TriangleMesh& mesh = site.bone.mesh();
  std::vector<Index> near;
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    const Vec3& p_L = mesh.vertices[std::size_t(v)];
    if (box.exteriorDistance(p_L) >= reach_mm) continue;
    const bool is_near = std::any_of(line.points_L.begin(), line.points_L.end(), [&](auto& q_L) {
      return (q_L - p_L).squaredNorm() < reach_mm * reach_mm;
    });
    if (is_near) near.push_back(v);
  }
  return near;
}

/// Mean normal of the vertices around one.
Vec3 smooth_normal(const GuideSite& site, const std::vector<Index>& near, const Vec3& p_L) {
  const TriangleMesh& mesh = site.bone.mesh();
  Vec3 sum = Vec3::Zero();
  for (const Index v : near)
    if ((mesh.vertices[std::size_t(v)] - p_L).norm() < kNormalRadius_mm)
      sum += site.bone.pseudonormals().at_vertex(mesh, v).normalized();
  return sum.normalized();
}

std::vector<Candidate> candidates_of(const GuideSite& site, const CutLine& line,
                                     const GuideOptions& guide, const HoleOptions& options) {
  constexpr double kFaces = 0.6;
  const std::vector<Index> near =
      vertices_near(site, line, guide.width_mm - 0.5 * options.diameter_mm - kRim_mm);
  std::vector<Candidate> found;
  for (const Index v : near) {
    Candidate one;
    one.point_L = site.bone.mesh().vertices[std::size_t(v)];
    const double from_mm = site.from_cut_mm(one.point_L);
    one.is_on_segment = from_mm < 0.0;
    one.from_cut_mm = one.is_on_segment ? -from_mm : from_mm - site.saw_mm;
    if (std::abs(one.from_cut_mm - options.from_cut_mm) > kTolerance_mm) continue;
    one.axis_L = smooth_normal(site, near, one.point_L);
    if (!(one.axis_L.dot(site.outward_L) > kFaces) ||
        !is_visible(site.bone, one.point_L, one.axis_L, site.outward_L))
      continue;
    one.position_mm = line.position_mm(one.point_L);
    found.push_back(one);
  }
  return found;
}

/// Thickness of the bone behind a point.
double bone_behind(const GuideSite& site, const Candidate& one) {
  constexpr double kInside_mm = 0.05, kMaxBone_mm = 20.0;
  const auto exit = site.bone.first_hit(one.point_L - kInside_mm * one.axis_L, -one.axis_L);
  return exit ? std::min(exit->distance_mm + kInside_mm, kMaxBone_mm) : kMaxBone_mm;
}

/// The best candidate on one side near a position, clear of the other holes.
std::optional<GuideHole> best_hole(const GuideSite& site, const std::vector<Candidate>& candidates,
                                   bool is_on_segment, double position_mm,
                                   const HoleOptions& options, const ClearOf& clear_of,
                                   const std::vector<GuideHole>& others) {
  constexpr double kThin_mm = 3.0, kMinBone_mm = 1.0, kReach_mm = 6.0;
  const double between_mm = 2.0 * options.diameter_mm + kRim_mm;
  std::optional<GuideHole> best;
  double least = std::numeric_limits<double>::infinity();
  for (const Candidate& one : candidates) {
    const double off_mm = std::abs(one.position_mm - position_mm);
    if (one.is_on_segment != is_on_segment || off_mm > kReach_mm) continue;
    double cost = off_mm + 2.0 * std::abs(one.from_cut_mm - options.from_cut_mm);
    if (cost >= least) continue;
    const bool is_close = std::any_of(others.begin(), others.end(), [&](const GuideHole& other) {
      return (other.point_L - one.point_L).norm() < between_mm;
    });
    if (is_close) continue;
    const double bone_mm = bone_behind(site, one);
    if (bone_mm < kMinBone_mm) continue;
    cost += 2.0 * std::max(0.0, kThin_mm - bone_mm);
    if (cost >= least) continue;
    const double clear_mm =
        clear_of(one.point_L, one.point_L - options.depth_mm * one.axis_L) - 0.5 * options.screw_mm;
    if (clear_mm < options.min_clear_mm) continue;
    least = cost;
    best = GuideHole{one.point_L, one.axis_L, is_on_segment, bone_mm, clear_mm};
  }
  return best;
}

}  // namespace

int holes_per_side(const CutLine& line) {
  constexpr double kLong_mm = 30.0;
  return line.last_mm() - line.first_mm() > kLong_mm ? 3 : 2;
}

std::vector<GuideHole> choose_holes(const GuideSite& site, const CutLine& line,
                                    const GuideOptions& guide, const HoleOptions& options,
                                    const ClearOf& clear_of) {
  constexpr double kFirst = 0.2, kLast = 0.8;
  const std::vector<Candidate> candidates = candidates_of(site, line, guide, options);
  const int count = holes_per_side(line);
  std::vector<GuideHole> holes;
  for (const bool is_on_segment : {true, false})
    for (int n = 0; n < count; ++n) {
      const double part = kFirst + (kLast - kFirst) * n / (count - 1);
      const double at_mm = line.first_mm() + part * (line.last_mm() - line.first_mm());
      if (const auto hole =
              best_hole(site, candidates, is_on_segment, at_mm, options, clear_of, holes))
        holes.push_back(*hole);
    }
  return holes;
}

Result<void> check_holes(const HoleOptions& options, const GuideOptions& guide) {
  const auto in = [](double value, double low, double high) {
    return value >= low && value <= high;
  };
  if (!in(options.diameter_mm, 1.0, 4.0) || !in(options.depth_mm, 2.0, 20.0) ||
      !in(options.from_cut_mm, 3.0, 15.0) || !in(options.min_clear_mm, 0.0, 10.0) ||
      !in(options.screw_mm, options.diameter_mm, 4.0))
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("holes of {} mm for screws of {} mm, {} mm deep, {} mm from the cut, {} "
                    "mm clear of roots and nerves: must be 1 to 4, that to 4, 2 to 20, 3 "
                    "to 15, 0 to 10",
                    options.diameter_mm, options.screw_mm, options.depth_mm, options.from_cut_mm,
                    options.min_clear_mm));
  const double closest_mm = kTolerance_mm + 0.5 * options.screw_mm + guide.slot_clearance_mm;
  if (options.from_cut_mm < closest_mm)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("holes are {:g} mm from the cut, must be {:.2f} mm or more for screws "
                            "of {:g} mm",
                            options.from_cut_mm, closest_mm, options.screw_mm));
  const double needed_mm = options.from_cut_mm + 0.5 * options.diameter_mm + kRim_mm;
  if (guide.width_mm < needed_mm)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("the guide is {:g} mm wide on each side of the cut, must be {:g} mm or "
                            "more for holes {:g} mm from the cut",
                            guide.width_mm, needed_mm, options.from_cut_mm));
  return {};
}

}  // namespace lefort::dental
