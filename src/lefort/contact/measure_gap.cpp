#include <lefort/contact/measure_gap.h>
#include <lefort/core/check.h>
#include <lefort/core/parallel.h>

#include <algorithm>
#include <array>

namespace lefort::contact {
namespace {

/// Points per query: their results fit into the first-level cache.
constexpr std::size_t kPointsPerTask = 32;

void measure_here(const RigidObstacle& obstacle, std::span<const Vec3> p_L, Derivatives derivatives,
                  std::span<Gap> gaps) {
  const Mat3 R_LB = obstacle.X_LB.linear();
  const Vec3 t_LB = obstacle.X_LB.translation();
  std::array<Vec3, kPointsPerTask> p_B;
  std::array<SignedDistanceSample, kPointsPerTask> answers;
  for (std::size_t begin = 0; begin < p_L.size(); begin += kPointsPerTask) {
    const std::size_t count = std::min(kPointsPerTask, p_L.size() - begin);
    for (std::size_t i = 0; i < count; ++i) p_B[i] = R_LB.transpose() * (p_L[begin + i] - t_LB);
    obstacle.distance_query_B->measure(std::span(p_B).first(count), derivatives,
                                       std::span(answers).first(count));
    for (std::size_t i = 0; i < count; ++i) {
      const SignedDistanceSample& answer = answers[i];
      Gap& gap = gaps[begin + i];
      gap.zone = answer.zone;
      gap.gap_mm = answer.distance_mm;
      gap.gradient_L = R_LB * answer.gradient_B;
      if (derivatives == Derivatives::kSecond)
        gap.hessian_L = R_LB * answer.hessian_B * R_LB.transpose();
      else
        gap.hessian_L.setZero();
    }
  }
}

}  // namespace

void measure_gaps(const RigidObstacle& obstacle, std::span<const Vec3> p_L, Derivatives derivatives,
                  std::span<Gap> gaps) {
  LEFORT_ASSERT(obstacle.distance_query_B != nullptr && gaps.size() == p_L.size());
  if (Index(p_L.size()) <= kParallelBlock) return measure_here(obstacle, p_L, derivatives, gaps);
  parallel_for_blocks(Index(p_L.size()), [&](Index begin, Index end) {
    const auto at = std::size_t(begin), count = std::size_t(end - begin);
    measure_here(obstacle, p_L.subspan(at, count), derivatives, gaps.subspan(at, count));
  });
}

Gap measure_gap(const RigidObstacle& obstacle, const Vec3& p_L, Derivatives derivatives) {
  Gap gap;
  measure_gaps(obstacle, {&p_L, 1}, derivatives, {&gap, 1});
  return gap;
}

std::pair<Gap, std::size_t> closest_gap(std::span<const RigidObstacle> obstacles, const Vec3& p_L) {
  std::pair<Gap, std::size_t> closest{measure_gap(obstacles[0], p_L, Derivatives::kFirst), 0};
  for (std::size_t k = 1; k < obstacles.size(); ++k)
    if (const Gap gap = measure_gap(obstacles[k], p_L, Derivatives::kFirst);
        gap.gap_mm < closest.first.gap_mm)
      closest = {gap, k};
  return closest;
}

}  // namespace lefort::contact
