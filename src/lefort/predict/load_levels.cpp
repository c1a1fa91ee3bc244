#include <lefort/predict/load_levels.h>

#include <algorithm>
#include <cmath>

namespace lefort::predict {
namespace {

/// Largest displacement of a vertex per path fraction, over all segments and keyframe intervals.
double max_speed_mm(const std::vector<geometry::RigidPath>& paths,
                    const std::vector<ContactBone>& segments) {
  double fastest_mm = 0.0;
  for (std::size_t k = 0; k < paths.size(); ++k) {
    double from = 0.0;
    for (const geometry::Keyframe& keyframe : paths[k].keyframes) {
      const double moved_mm = geometry::max_displacement_mm(
          paths[k], segments[k].surface_B.vertices, from, keyframe.path_fraction);
      fastest_mm = std::max(fastest_mm, moved_mm / (keyframe.path_fraction - from));
      from = keyframe.path_fraction;
    }
  }
  return fastest_mm;
}

}  // namespace

std::vector<LoadLevel> load_levels(const std::vector<geometry::RigidPath>& paths, int increments) {
  constexpr double kSame = 1e-9;  // Path fraction; a keyframe at 0.3333333333 is step 1 of 3.
  const int count = increments * geometry::steps_of(paths);
  std::vector<LoadLevel> levels;
  for (int n = 1; n <= count; ++n) levels.push_back({double(n) / count, n % increments == 0});
  for (const geometry::RigidPath& path : paths)
    for (const geometry::Keyframe& keyframe : path.keyframes) {
      const bool known = std::any_of(levels.begin(), levels.end(), [&](const LoadLevel& level) {
        return std::abs(level.path_fraction - keyframe.path_fraction) <= kSame;
      });
      if (!known) levels.push_back({keyframe.path_fraction, false});
    }
  std::sort(levels.begin(), levels.end(), [](const LoadLevel& a, const LoadLevel& b) {
    return a.path_fraction < b.path_fraction;
  });
  return levels;
}

double max_increment_mm(const TissueOptions& tissue, Obstacle obstacle, double max_distance_mm) {
  constexpr double kDistanceFraction = 0.5;  // docs/theory/contact.md
  return std::min(increment_element_fraction(obstacle) * tissue.element_size_mm,
                  kDistanceFraction * max_distance_mm);
}

int increments_of_step(const TissueOptions& tissue, Obstacle obstacle,
                       const std::vector<geometry::RigidPath>& paths,
                       const std::vector<ContactBone>& segments, double max_distance_mm) {
  constexpr double kRoundOff = 1e-9;  // Of the number of increments.
  const double max_mm = max_increment_mm(tissue, obstacle, max_distance_mm);
  const double step_mm = max_speed_mm(paths, segments) / geometry::steps_of(paths);
  return int(std::max(std::ceil(step_mm / max_mm - kRoundOff), 1.0));
}

}  // namespace lefort::predict
