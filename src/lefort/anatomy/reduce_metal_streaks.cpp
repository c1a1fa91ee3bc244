#include <lefort/anatomy/reduce_metal_streaks.h>
#include <lefort/core/parallel.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <vector>

namespace lefort::anatomy {
namespace {

// Neighboring voxels of a slice differ by less than this without metal: enamel in air, 3500 HU,
// blurred by a sharp kernel.
constexpr int kMetalStep_hu = 2200;
// Area of the voxels with such a neighbor from which a slice has streaks.
constexpr double kMinArea_mm2 = 30.0;
// How far bone, teeth, skin and air may lie beyond their place in the slices without streaks.
constexpr double kReach_mm = 3.0;
// Soft tissue is plausible also this far beyond tissue, as lips, nose and ears differ from slice to
// slice.
constexpr double kSoftReach_mm = 8.0;
constexpr std::int16_t kSoftTissue_hu = 100;
// Further slices are no evidence of the anatomy.
constexpr double kMaxGap_mm = 15.0;
// A dark voxel between as many bright ones is metal whose number exceeded the range of the file.
constexpr int kWrappedNeighbors = 5;
constexpr std::int16_t kMetal_hu = 3000;

/// A slice; x runs fastest.
struct Slice {
  Index width = 0, height = 0;
  double dx_mm = 1.0, dy_mm = 1.0;
  std::vector<std::int16_t> values;

  [[nodiscard]] std::int16_t& at(Index x, Index y) { return values[std::size_t(x + width * y)]; }
  [[nodiscard]] std::int16_t at(Index x, Index y) const {
    return values[std::size_t(x + width * y)];
  }
};

/// Access to the slices across one axis of a volume.
struct SliceAxis {
  const image::Grid& grid;
  std::size_t across, x, y;

  explicit SliceAxis(const image::Grid& of) : grid(of), across(0), x(0), y(0) {
    for (std::size_t axis = 1; axis < 3; ++axis)
      if (std::abs(of.direction(2, Index(axis))) > std::abs(of.direction(2, Index(across))))
        across = axis;
    x = across == 0 ? 1 : 0;
    y = across == 2 ? 1 : 2;
  }
  [[nodiscard]] Index count() const { return grid.size[across]; }
  [[nodiscard]] double spacing_mm() const { return grid.spacing_mm[Index(across)]; }
  /// Calls visit(number in the slice, offset in the volume) for each voxel.
  template <class Visit>
  void for_each(Index slice, const Visit& visit) const {
    const std::array<Index, 3> stride{1, grid.size[0], grid.size[0] * grid.size[1]};
    std::size_t n = 0;
    for (Index b = 0; b < grid.size[y]; ++b)
      for (Index a = 0; a < grid.size[x]; ++a)
        visit(n++, std::size_t(slice * stride[across] + a * stride[x] + b * stride[y]));
  }
  [[nodiscard]] Slice read(const image::CtVolume& ct, Index slice) const {
    Slice values{grid.size[x], grid.size[y], grid.spacing_mm[Index(x)], grid.spacing_mm[Index(y)],
                 std::vector<std::int16_t>(std::size_t(grid.size[x] * grid.size[y]))};
    for_each(slice, [&](std::size_t n, std::size_t v) { values.values[n] = ct.values[v]; });
    return values;
  }
};

/// Area of the voxels with a neighbor that differs by more than kMetalStep_hu.
double metal_area_mm2(const Slice& slice) {
  Index steps = 0;
  for (Index y = 0; y < slice.height; ++y)
    for (Index x = 0; x < slice.width; ++x) {
      const int here = slice.at(x, y);
      if (x > 0 && std::abs(here - slice.at(x - 1, y)) > kMetalStep_hu) ++steps;
      if (y > 0 && std::abs(here - slice.at(x, y - 1)) > kMetalStep_hu) ++steps;
    }
  return double(steps) * slice.dx_mm * slice.dy_mm;
}

/// The extreme by `better` of a slice over a disk around each voxel.
template <class Better>
Slice over_disk(const Slice& slice, double radius_mm, const Better& better) {
  std::vector<std::array<Index, 2>> rows;  // Of the disk: its y, and half its width.
  const Index reach = Index(radius_mm / slice.dy_mm);
  for (Index y = -reach; y <= reach; ++y) {
    const double y_mm = double(y) * slice.dy_mm;
    rows.push_back({y, Index(std::sqrt(radius_mm * radius_mm - y_mm * y_mm) / slice.dx_mm)});
  }
  Slice result = slice;
  parallel_for(slice.height, [&](Index y) {
    for (Index x = 0; x < slice.width; ++x) {
      std::int16_t best = slice.at(x, y);
      for (const auto& [dy, half] : rows) {
        if (y + dy < 0 || y + dy >= slice.height) continue;
        const Index first = std::max<Index>(x - half, 0);
        const Index last = std::min(x + half, slice.width - 1);
        for (Index at = first; at <= last; ++at)
          if (better(slice.at(at, y + dy), best)) best = slice.at(at, y + dy);
      }
      result.at(x, y) = best;
    }
  });
  return result;
}

Slice max_over_disk(const Slice& slice, double radius_mm) {
  return over_disk(slice, radius_mm, [](std::int16_t a, std::int16_t b) { return a > b; });
}
Slice min_over_disk(const Slice& slice, double radius_mm) {
  return over_disk(slice, radius_mm, [](std::int16_t a, std::int16_t b) { return a < b; });
}

/// The plausible range of CT numbers between two slices without streaks.
struct Limits {
  Slice low, high;
};

Limits limits_between(const Slice& below, const Slice& above, double bone_hu, double skin_hu) {
  Slice least = below, most = below;
  for (std::size_t n = 0; n < least.values.size(); ++n) {
    least.values[n] = std::min(below.values[n], above.values[n]);
    most.values[n] = std::max(below.values[n], above.values[n]);
  }
  Limits limits{min_over_disk(least, kReach_mm), max_over_disk(most, kReach_mm)};
  const Slice tissue = max_over_disk(most, kSoftReach_mm);
  for (std::size_t n = 0; n < least.values.size(); ++n) {
    if (double(least.values[n]) >= bone_hu) limits.low.values[n] = least.values[n];
    if (double(tissue.values[n]) >= skin_hu)
      limits.high.values[n] = std::max(limits.high.values[n], kSoftTissue_hu);
  }
  return limits;
}

/// Sets metal whose numbers wrapped to negative ones to kMetal_hu.
void restore_wrapped_metal(Slice& slice) {
  const Slice stored = slice;
  for (Index y = 1; y + 1 < slice.height; ++y)
    for (Index x = 1; x + 1 < slice.width; ++x) {
      int bright = 0;
      for (Index b = -1; b <= 1; ++b)
        for (Index a = -1; a <= 1; ++a)
          if (stored.at(x + a, y + b) - stored.at(x, y) > kMetalStep_hu) ++bright;
      if (bright >= kWrappedNeighbors) slice.at(x, y) = kMetal_hu;
    }
}

}  // namespace

StreakReduction reduce_metal_streaks(const image::CtVolume& ct, double bone_hu, double skin_hu) {
  const SliceAxis slices(ct.grid);
  std::vector<char> has_streaks(std::size_t(slices.count()), 0);
  parallel_for(slices.count(), [&](Index k) {
    has_streaks[std::size_t(k)] = metal_area_mm2(slices.read(ct, k)) >= kMinArea_mm2 ? 1 : 0;
  });
  StreakReduction result{ct, 0};
  for (Index first = 0; first < slices.count(); ++first) {
    if (has_streaks[std::size_t(first)] == 0) continue;
    Index end = first;
    while (end < slices.count() && has_streaks[std::size_t(end)] != 0) ++end;
    const bool is_between = first > 0 && end < slices.count();
    const double gap_mm = double(end - first + 1) * slices.spacing_mm();
    if (is_between && gap_mm <= 2.0 * kMaxGap_mm) {
      const Limits limits =
          limits_between(slices.read(ct, first - 1), slices.read(ct, end), bone_hu, skin_hu);
      for (Index k = first; k < end; ++k) {
        Slice slice = slices.read(ct, k);
        restore_wrapped_metal(slice);
        for (std::size_t n = 0; n < slice.values.size(); ++n)
          slice.values[n] =
              std::clamp(slice.values[n], limits.low.values[n], limits.high.values[n]);
        slices.for_each(
            k, [&](std::size_t n, std::size_t v) { result.ct.values[v] = slice.values[n]; });
        ++result.slices;
      }
    }
    first = end;
  }
  return result;
}

}  // namespace lefort::anatomy
