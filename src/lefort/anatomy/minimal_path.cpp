#include <lefort/anatomy/minimal_path.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

namespace lefort::anatomy {
namespace {

using Arrival = std::pair<float, Index>;  // Equal times: the smaller offset first.

class Front {
 public:
  explicit Front(const image::ScalarVolume& speed)
      : speed_(speed),
        times_{speed.grid, std::vector<float>(speed.values.size(), kNeverReached)},
        is_final_(speed.values.size(), 0) {}

  void start(const FrontSource& source) {
    if (source.voxel < 0 || source.voxel >= speed_.grid.voxel_count()) return;
    float& time = times_.values[std::size_t(source.voxel)];
    if (source.time >= time) return;
    time = source.time;
    heap_.emplace(time, source.voxel);
  }

  image::ScalarVolume march(Index target) && {
    while (!heap_.empty()) {
      const auto [time, v] = heap_.top();
      heap_.pop();
      if (is_final_[std::size_t(v)] != 0) continue;
      is_final_[std::size_t(v)] = 1;
      if (v == target) break;
      update_neighbors(v);
    }
    // Times that are not final are upper bounds.
    for (std::size_t v = 0; v < is_final_.size(); ++v)
      if (is_final_[v] == 0) times_.values[v] = kNeverReached;
    return std::move(times_);
  }

 private:
  [[nodiscard]] std::array<Index, 3> indices(Index v) const {
    const auto& size = speed_.grid.size;
    return {v % size[0], v / size[0] % size[1], v / (size[0] * size[1])};
  }

  void update_neighbors(Index v) {
    const auto at = indices(v);
    const auto& size = speed_.grid.size;
    const std::array<Index, 3> stride{1, size[0], size[0] * size[1]};
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const Index side : {Index(-1), Index(1)}) {
        if (at[axis] + side < 0 || at[axis] + side >= size[axis]) continue;
        const Index next = v + side * stride[axis];
        if (is_final_[std::size_t(next)] != 0 || !(speed_.values[std::size_t(next)] > 0.0F))
          continue;
        const auto time = float(solved(next));
        if (time < times_.values[std::size_t(next)]) {
          times_.values[std::size_t(next)] = time;
          heap_.emplace(time, next);
        }
      }
  }

  /// The time at v from its final neighbors: the largest root of sum ((T - T_a) / h_a)^2 = 1 / F^2
  /// over the axes whose neighbor is earlier than the root.
  [[nodiscard]] double solved(Index v) const {
    const auto at = indices(v);
    const auto& size = speed_.grid.size;
    const std::array<Index, 3> stride{1, size[0], size[0] * size[1]};
    std::array<std::pair<double, double>, 3> known{};  // Time and spacing.
    std::size_t count = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      double earliest = kNeverReached;
      for (const Index side : {Index(-1), Index(1)}) {
        if (at[axis] + side < 0 || at[axis] + side >= size[axis]) continue;
        const auto next = std::size_t(v + side * stride[axis]);
        if (is_final_[next] != 0) earliest = std::min(earliest, double(times_.values[next]));
      }
      if (earliest < kNeverReached)
        known[count++] = {earliest, speed_.grid.spacing_mm[Index(axis)]};
    }
    std::sort(known.begin(), known.begin() + std::ptrdiff_t(count));
    const double slowness = 1.0 / double(speed_.values[std::size_t(v)]);
    double a = 0.0, b = 0.0, c = -slowness * slowness;
    double time = kNeverReached;
    for (std::size_t n = 0; n < count; ++n) {
      const auto [earlier, h] = known[n];
      if (earlier >= time) break;
      a += 1.0 / (h * h);
      b += earlier / (h * h);
      c += earlier * earlier / (h * h);
      time = (b + std::sqrt(std::max(0.0, b * b - a * c))) / a;
    }
    return time;
  }

  const image::ScalarVolume& speed_;
  image::ScalarVolume times_;
  std::vector<std::uint8_t> is_final_;
  std::priority_queue<Arrival, std::vector<Arrival>, std::greater<>> heap_;
};

/// The neighbor with the steepest descent; v itself at a minimum.
Index steepest_neighbor(const image::ScalarVolume& times, Index v) {
  const auto& size = times.grid.size;
  const Index i = v % size[0], j = v / size[0] % size[1], k = v / (size[0] * size[1]);
  Index best = v;
  double steepest = 0.0;
  for (Index dk = -1; dk <= 1; ++dk)
    for (Index dj = -1; dj <= 1; ++dj)
      for (Index di = -1; di <= 1; ++di) {
        if (!times.grid.contains(i + di, j + dj, k + dk)) continue;
        const Index next = times.grid.offset(i + di, j + dj, k + dk);
        const double drop =
            double(times.values[std::size_t(v)]) - double(times.values[std::size_t(next)]);
        if (!(drop > 0.0)) continue;
        const double slope =
            drop /
            Vec3(double(di), double(dj), double(dk)).cwiseProduct(times.grid.spacing_mm).norm();
        if (slope > steepest) {
          steepest = slope;
          best = next;
        }
      }
  return best;
}

/// Point of a polyline at each multiple of the spacing, and its last point.
std::vector<Vec3> resampled(std::span<const Vec3> path_L, double spacing_mm) {
  std::vector<Vec3> points{path_L.front()};
  double next_mm = spacing_mm, done_mm = 0.0;
  for (std::size_t n = 1; n < path_L.size(); ++n) {
    const double segment_mm = (path_L[n] - path_L[n - 1]).norm();
    for (; next_mm <= done_mm + segment_mm && segment_mm > 0.0; next_mm += spacing_mm)
      points.push_back(path_L[n - 1] +
                       (path_L[n] - path_L[n - 1]) * ((next_mm - done_mm) / segment_mm));
    done_mm += segment_mm;
  }
  if ((points.back() - path_L.back()).norm() > 0.01 * spacing_mm)
    points.push_back(path_L.back());
  else
    points.back() = path_L.back();
  return points;
}

}  // namespace

image::ScalarVolume arrival_times(const image::ScalarVolume& speed,
                                  std::span<const FrontSource> sources, Index target) {
  Front front(speed);
  for (const FrontSource& source : sources) front.start(source);
  return std::move(front).march(target);
}

std::vector<Vec3> minimal_path(const image::ScalarVolume& times, Index from) {
  std::vector<Vec3> path_L;
  if (from < 0 || from >= times.grid.voxel_count() ||
      !(times.values[std::size_t(from)] < kNeverReached))
    return path_L;
  const auto& size = times.grid.size;
  for (Index v = from;;) {
    const Index row = v / size[0];
    const Index i = v % size[0], j = row % size[1], k = row / size[1];
    path_L.push_back(times.grid.point_L({double(i), double(j), double(k)}));
    const Index next = steepest_neighbor(times, v);
    if (next == v) break;
    v = next;
  }
  std::reverse(path_L.begin(), path_L.end());
  return path_L;
}

std::vector<Vec3> smoothed_path(std::span<const Vec3> path_L, double sigma_mm, double spacing_mm) {
  if (path_L.size() < 2 || !(length_mm(path_L) > 0.0)) return {path_L.begin(), path_L.end()};
  std::vector<Vec3> points = resampled(path_L, spacing_mm);
  if (sigma_mm <= 0.0) return points;
  const std::vector<Vec3> rough = points;
  const auto count = std::ptrdiff_t(points.size());
  const auto reach = std::ptrdiff_t(std::ceil(3.0 * sigma_mm / spacing_mm));
  for (std::ptrdiff_t n = 1; n + 1 < count; ++n) {
    // Symmetric about n, so that the ends do not shorten the path.
    const std::ptrdiff_t most = std::min({reach, n, count - 1 - n});
    Vec3 sum = Vec3::Zero();
    double weights = 0.0;
    for (std::ptrdiff_t m = -most; m <= most; ++m) {
      const double t = double(m) * spacing_mm / sigma_mm;
      const double weight = std::exp(-0.5 * t * t);
      sum += weight * rough[std::size_t(n + m)];
      weights += weight;
    }
    points[std::size_t(n)] = sum / weights;
  }
  return points;
}

double length_mm(std::span<const Vec3> path_L) {
  double sum_mm = 0.0;
  for (std::size_t n = 1; n < path_L.size(); ++n) sum_mm += (path_L[n] - path_L[n - 1]).norm();
  return sum_mm;
}

}  // namespace lefort::anatomy
