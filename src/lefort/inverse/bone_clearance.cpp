#include <lefort/contact/bone_overlap.h>
#include <lefort/contact/measure_gap.h>
#include <lefort/core/check.h>
#include <lefort/inverse/bone_clearance.h>

#include <algorithm>
#include <utility>

namespace lefort::inverse {
namespace {

/// Velocity of a point of a bone by one number; zero if the bone is not moved by it.
Vec3 velocity(const predict::PoseRate& rate, std::size_t bone, const Vec3& p_L) {
  for (const auto& [segment, motion] : rate)
    if (segment == bone) return motion.at(p_L);
  return Vec3::Zero();
}

}  // namespace

BoneClearance::BoneClearance(std::vector<predict::MovingBone> bones, double allowed_mm)
    : bones_(std::move(bones)), allowed_mm_(allowed_mm) {
  LEFORT_CHECK(allowed_mm_ >= 0.0);
}

RigidTransform BoneClearance::pose(std::size_t bone, std::span<const RigidTransform> X_LB) const {
  return bone < X_LB.size() ? X_LB[bone] : RigidTransform::Identity();
}

std::vector<OverlapRow> BoneClearance::rows(std::span<const RigidTransform> X_LB,
                                            std::span<const predict::PoseRate> rates) const {
  const double threshold_mm = std::max(kThreshold * allowed_mm_, contact::kTouching_mm);
  std::vector<OverlapRow> rows;
  for (std::size_t a = 0; a < bones_.size(); ++a)
    for (std::size_t b = 0; b < bones_.size(); ++b) {
      if (a == b) continue;
      const std::vector<Vec3>& vertices_B = bones_[a].surface_B->vertices;
      const RigidTransform X_LA = pose(a, X_LB);
      std::vector<Vec3> p_L(vertices_B.size());
      for (std::size_t v = 0; v < p_L.size(); ++v) p_L[v] = X_LA * vertices_B[v];
      std::vector<contact::Gap> gaps(p_L.size());
      contact::measure_gaps({bones_[b].distance_query_B, pose(b, X_LB)}, p_L,
                            contact::Derivatives::kFirst, gaps);
      for (std::size_t v = 0; v < p_L.size(); ++v) {
        if (gaps[v].zone != field::Zone::kBand || -gaps[v].gap_mm <= threshold_mm) continue;
        OverlapRow row{.excess_mm = -gaps[v].gap_mm - threshold_mm, .derivative = {}};
        row.derivative.resize(Index(rates.size()));
        for (std::size_t n = 0; n < rates.size(); ++n)
          row.derivative[Index(n)] = -gaps[v].gradient_L.dot(velocity(rates[n], a, p_L[v]) -
                                                             velocity(rates[n], b, p_L[v]));
        rows.push_back(std::move(row));
      }
    }
  return rows;
}

DeepestOverlap BoneClearance::deepest(std::span<const RigidTransform> X_LB) const {
  DeepestOverlap deepest;
  for (std::size_t a = 0; a < bones_.size(); ++a)
    for (std::size_t b = a + 1; b < bones_.size(); ++b) {
      const contact::BoneOverlap overlap = contact::measure_overlap(
          {bones_[a].surface_B, {bones_[a].distance_query_B, pose(a, X_LB)}},
          {bones_[b].surface_B, {bones_[b].distance_query_B, pose(b, X_LB)}},
          std::min(bones_[a].cell_mm, bones_[b].cell_mm));
      if (overlap.deepest_mm > deepest.depth_mm ||
          (overlap.depth_is_lower_bound && !deepest.is_lower_bound))
        deepest = {overlap.deepest_mm, overlap.depth_is_lower_bound || deepest.is_lower_bound,
                   bones_[a].name, bones_[b].name};
    }
  return deepest;
}

}  // namespace lefort::inverse
