#include <lefort/contact/distance_query.h>
#include <lefort/core/check.h>
#include <lefort/geometry/bvh.h>
#include <lefort/geometry/rigid_path.h>
#include <lefort/predict/check_plan.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

namespace lefort::predict {
namespace {

/// A bone with its distance query and tree.
struct Bone : MovingBone {
  const plan::PlannedSegment* planned;  ///< Null for the remainder.
  std::unique_ptr<const geometry::Bvh> tree_B;
};

Result<Bone> make_bone(std::string name, const geometry::TriangleMesh& surface_B,
                       const plan::PlannedSegment* planned,
                       const field::DistanceFieldOptions& options, Progress& progress) {
  LEFORT_TRY(field::DistanceField field, field::build_distance_field(surface_B, options, progress));
  const auto shared = std::make_shared<const field::DistanceField>(std::move(field));
  LEFORT_TRY(auto distance_query_B,
             contact::field_distance_query(shared, contact::DetectionMethod::kTrilinear));
  return Bone{{std::move(name), &surface_B, planned == nullptr ? nullptr : &planned->path,
               std::move(distance_query_B), shared->cell_mm()},
              planned,
              std::make_unique<geometry::Bvh>(surface_B)};
}

Result<std::vector<Bone>> make_bones(const plan::CutSegments& cut,
                                     std::span<const plan::PlannedSegment> planned,
                                     const field::DistanceFieldOptions& options,
                                     Progress& progress) {
  std::vector<Bone> bones;
  for (std::size_t k = 0; k < planned.size(); ++k) {
    LEFORT_TRY(Bone bone, make_bone(planned[k].osteotomy.segment, cut.segments_L[k], &planned[k],
                                    options, progress));
    bones.push_back(std::move(bone));
  }
  LEFORT_TRY(Bone stationary, make_bone(kRemainder, cut.remainder_L, nullptr, options, progress));
  bones.push_back(std::move(stationary));
  return bones;
}

/// Steps of the path with the most steps, and all keyframes, ascending.
std::vector<double> fractions_of(std::span<const plan::PlannedSegment> planned) {
  const int steps = geometry::steps_of(plan::paths_of(planned));
  std::vector<double> fractions;
  for (int step = 1; step <= steps; ++step) fractions.push_back(double(step) / steps);
  for (const plan::PlannedSegment& one : planned)
    for (const geometry::Keyframe& key : one.path.keyframes) fractions.push_back(key.path_fraction);
  std::sort(fractions.begin(), fractions.end());
  fractions.erase(std::unique(fractions.begin(), fractions.end()), fractions.end());
  return fractions;
}

/// The deepest overlap of a pair along the path, if there is any.
std::optional<BoneOverlapAtFraction> deepest_overlap(const Bone& first, const Bone& second,
                                                     std::span<const double> fractions,
                                                     const Progress& progress) {
  std::optional<BoneOverlapAtFraction> deepest;
  for (const double path_fraction : fractions) {
    if (progress.stop_requested()) break;
    BoneOverlapAtFraction pair = overlap_at(path_fraction, first, second);
    if (!pair.overlap.overlaps()) continue;
    if (!deepest || pair.overlap.deepest_mm > deepest->overlap.deepest_mm)
      deepest = std::move(pair);
  }
  return deepest;
}

/// A small part of a cut face.
struct CutSample {
  Vec3 point_B;
  double area_mm2;
};

/// Points of a segment's surface within a kerf of other bone at rest.
std::vector<CutSample> cut_samples(const std::vector<Bone>& bones, std::size_t segment) {
  constexpr double kSpacing_mm = 1.0;
  const double near_mm = bones[segment].planned->osteotomy.kerf_mm + contact::kTouching_mm;
  const geometry::TriangleMesh& mesh = *bones[segment].surface_B;
  const auto has_neighbor = [&](const Vec3& p_L) {
    for (std::size_t b = 0; b < bones.size(); ++b)
      if (b != segment && bones[b].tree_B->closest_point(p_L, near_mm)) return true;
    return false;
  };
  std::vector<CutSample> samples;
  for (Index t = 0; t < mesh.triangle_count(); ++t) {
    const Vec3 &a = mesh.corner(t, 0), &b = mesh.corner(t, 1), &c = mesh.corner(t, 2);
    const double longest_mm = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    const int parts = std::max(1, int(std::ceil(longest_mm / kSpacing_mm)));
    const double area_mm2 = 0.5 * (b - a).cross(c - a).norm() / (double(parts) * parts);
    // Centroids of the small triangles, upright ones first.
    for (int i = 0; i < parts; ++i)
      for (int j = 0; i + j < parts; ++j)
        for (int inverted = 0; inverted < (i + j + 1 < parts ? 2 : 1); ++inverted) {
          const double third = inverted == 0 ? 1.0 / 3.0 : 2.0 / 3.0;
          const Vec3 p = a + (i + third) / parts * (b - a) + (j + third) / parts * (c - a);
          if (has_neighbor(p)) samples.push_back({p, area_mm2});
        }
  }
  return samples;
}

SegmentSupport measure_support(const std::vector<Bone>& bones, std::size_t segment,
                               const PlanLimits& limits) {
  SegmentSupport support;
  support.segment = bones[segment].name;
  const RigidTransform X_end = bones[segment].pose_at(1.0);
  std::vector<RigidTransform> X_BL;
  X_BL.reserve(bones.size());
  for (const Bone& bone : bones) X_BL.push_back(bone.pose_at(1.0).inverse());
  double gap_volume_mm3 = 0.0;
  for (const auto& [point_B, area_mm2] : cut_samples(bones, segment)) {
    const Vec3 p_L = X_end * point_B;
    double gap_mm = std::numeric_limits<double>::infinity();
    for (std::size_t b = 0; b < bones.size(); ++b) {
      if (b == segment) continue;
      const auto nearest = bones[b].tree_B->closest_point(X_BL[b] * p_L, gap_mm);
      if (nearest) gap_mm = std::min(gap_mm, nearest->distance_mm);
    }
    support.cut_area_mm2 += area_mm2;
    gap_volume_mm3 += gap_mm * area_mm2;
    if (gap_mm <= limits.support_mm) support.supported_area_mm2 += area_mm2;
    if (gap_mm <= support.max_gap_mm) continue;
    support.max_gap_mm = gap_mm;
    support.max_gap_L = p_L;
  }
  if (support.cut_area_mm2 > 0.0) support.mean_gap_mm = gap_volume_mm3 / support.cut_area_mm2;
  return support;
}

std::string format_point(const Vec3& p) {
  return fmt::format("({:.1f}, {:.1f}, {:.1f}) mm", p.x(), p.y(), p.z());
}

std::vector<PlanFinding> find_findings(const PlanCheck& check,
                                       std::span<const plan::PlannedSegment> planned,
                                       const PlanLimits& limits) {
  std::vector<PlanFinding> findings;
  for (const BoneOverlapAtFraction& pair : check.overlaps) {
    const contact::BoneOverlap& overlap = pair.overlap;
    if (!(overlap.deepest_mm > limits.overlap_mm)) continue;
    findings.push_back(
        {FindingKind::kOverlap, pair.first,
         fmt::format("{} and {} overlap: at {:.1f} % of the path the common volume is {:.2f} ml, "
                     "{}{:.2f} mm deep at {}",
                     pair.first, pair.second, 100.0 * pair.path_fraction, overlap.volume_mm3 * 1e-3,
                     overlap.depth_is_lower_bound ? "more than " : "up to ", overlap.deepest_mm,
                     format_point(overlap.deepest_L))});
  }
  for (std::size_t k = 0; k < planned.size(); ++k) {
    if (planned[k].is_distracted) continue;
    const SegmentSupport& support = check.supports[k];
    if (support.max_gap_mm > limits.gap_mm)
      findings.push_back(
          {FindingKind::kGap, support.segment,
           fmt::format("a gap of {:.1f} mm opens at a cut face of {}, at {}; the limit is {:g} mm",
                       support.max_gap_mm, support.segment, format_point(support.max_gap_L),
                       limits.gap_mm)});
    if (support.supported_fraction() < limits.support_fraction)
      findings.push_back(
          {FindingKind::kMissingSupport, support.segment,
           fmt::format(
               "{} has too little support: {:.0f} of {:.0f} mm2 of its cut faces lie within "
               "{:g} mm of other bone; the minimum is {:.0f} %",
               support.segment, support.supported_area_mm2, support.cut_area_mm2, limits.support_mm,
               100.0 * limits.support_fraction)});
  }
  return findings;
}

}  // namespace

const char* name_of(FindingKind kind) {
  switch (kind) {
    case FindingKind::kOverlap:
      return "overlap";
    case FindingKind::kGap:
      return "gap";
    case FindingKind::kMissingSupport:
      return "missing_support";
    case FindingKind::kToothRoot:
      return "tooth_root";
    case FindingKind::kNerve:
      return "nerve";
  }
  return "";
}

Result<PlanCheck> check_plan(const plan::CutSegments& cut,
                             std::span<const plan::PlannedSegment> planned,
                             const PlanLimits& limits, field::DistanceFieldOptions field,
                             Progress& progress) {
  LEFORT_CHECK(cut.segments_L.size() == planned.size());
  field.smooth = false;
  LEFORT_TRY(const std::vector<Bone> bones, make_bones(cut, planned, field, progress));
  const std::vector<double> fractions = fractions_of(planned);
  PlanCheck check;
  for (std::size_t a = 0; a + 1 < bones.size(); ++a)
    for (std::size_t b = a + 1; b < bones.size(); ++b)
      if (auto pair = deepest_overlap(bones[a], bones[b], fractions, progress))
        check.overlaps.push_back(*std::move(pair));
  for (std::size_t k = 0; k < planned.size(); ++k) {
    if (progress.stop_requested())
      return fail(ErrorCode::kCancelled, "the plan check was cancelled");
    check.supports.push_back(measure_support(bones, k, limits));
  }
  check.findings = find_findings(check, planned, limits);
  return check;
}

}  // namespace lefort::predict
