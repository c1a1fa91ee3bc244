#include <lefort/anatomy/pad_volume.h>
#include <lefort/anatomy/voxel_mask.h>
#include <lefort/core/decompositions.h>
#include <lefort/dental/assign_fdi.h>
#include <lefort/dental/number_teeth.h>
#include <lefort/dental/split_teeth.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <utility>

namespace lefort::dental {
namespace {

using anatomy::Tooth;

constexpr double kDynamic_mm = 0.5;
constexpr double kMinTooth_mm3 = 60.0;
constexpr double kOcclusalPart_mm = 6.0;

/// The teeth of one jaw, on a part of the grid.
struct Jaw {
  anatomy::Mask mask;
  image::Volume<std::int32_t> parts;
  Tooth jaw = Tooth::kUpper;
  DentalFrame frame;

  [[nodiscard]] Vec3 center(std::size_t v) const { return mask.grid.center_L(Index(v)); }
  /// Height towards the other jaw.
  [[nodiscard]] double height_mm(const Vec3& p_L) const {
    const double up = frame.superior_L.dot(p_L);
    return jaw == Tooth::kUpper ? -up : up;
  }
};

/// The dental arch in the axial plane, in polar coordinates about a point behind it.
class Arch {
 public:
  explicit Arch(const Jaw& jaw);

  /// Length of the curve from the mid-sagittal plane to the sector of a point; to the left > 0.
  [[nodiscard]] double along_mm(const Vec3& p_L) const {
    const double at = std::clamp(sector(p_L), 0.0, double(kSectors) - 1.001);
    const auto lower = std::size_t(at);
    const double t = at - double(lower);
    return (1.0 - t) * along_mm_[lower] + t * along_mm_[lower + 1];
  }
  /// Whether a voxel belongs to the occlusal part of the arch at its place.
  [[nodiscard]] bool is_crown(const Vec3& p_L, double height_mm) const {
    return height_mm > highest_mm_[bin(p_L)] - kOcclusalPart_mm;
  }

 private:
  static constexpr int kSectors = 90;

  /// Sector of a point, from right to left.
  [[nodiscard]] double sector(const Vec3& p_L) const {
    const double x = frame_.left_L.dot(p_L - origin_L_), y = frame_.anterior_L.dot(p_L - origin_L_);
    // From -120 to 120 degrees about the anterior direction.
    const double angle = std::atan2(x, y) / (2.0 * std::numbers::pi / 3.0);
    return 0.5 * (angle + 1.0) * double(kSectors - 1);
  }

  /// The closest sector.
  [[nodiscard]] std::size_t bin(const Vec3& p_L) const {
    return std::size_t(std::clamp(std::lround(sector(p_L)), 0L, long(kSectors) - 1L));
  }

  DentalFrame frame_;
  Vec3 origin_L_ = Vec3::Zero();
  std::vector<double> along_mm_, highest_mm_;
};

/// The median; NaN if empty.
double median_or_nan(std::vector<double> values) {
  if (values.empty()) return std::nan("");
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Fills NaN between known values linearly, and beyond them with the last one.
void fill_gaps(std::vector<double>& values) {
  std::ptrdiff_t last = -1;
  const auto count = std::ptrdiff_t(values.size());
  for (std::ptrdiff_t n = 0; n <= count; ++n) {
    if (n < count && std::isnan(values[std::size_t(n)])) continue;
    for (std::ptrdiff_t m = last + 1; m < n; ++m) {
      const double t = double(m - last) / double(n - last);
      const double before = last >= 0 ? values[std::size_t(last)] : std::nan("");
      const double after = n < count ? values[std::size_t(n)] : std::nan("");
      values[std::size_t(m)] = last < 0     ? after
                               : n == count ? before
                                            : before + t * (after - before);
    }
    last = n;
  }
}

std::vector<double> smoothed_values(const std::vector<double>& values, int reach) {
  std::vector<double> smooth(values.size());
  const auto count = int(values.size());
  for (int n = 0; n < count; ++n) {
    double sum = 0.0;
    for (int m = -reach; m <= reach; ++m)
      sum += values[std::size_t(std::clamp(n + m, 0, count - 1))];
    smooth[std::size_t(n)] = sum / double(2 * reach + 1);
  }
  return smooth;
}

Arch::Arch(const Jaw& jaw) : frame_(jaw.frame) {
  // The origin: in the mid-sagittal plane, at the posterior third of the arch.
  double front_mm = -std::numeric_limits<double>::infinity(), back_mm = -front_mm;
  for (std::size_t v = 0; v < jaw.mask.values.size(); ++v) {
    if (jaw.mask.values[v] == 0) continue;
    const double y = frame_.anterior_L.dot(jaw.center(v));
    front_mm = std::max(front_mm, y);
    back_mm = std::min(back_mm, y);
  }
  constexpr double kOrigin = 0.3;
  const double origin_mm = back_mm + kOrigin * (front_mm - back_mm);
  origin_L_ =
      frame_.midline_L + (origin_mm - frame_.anterior_L.dot(frame_.midline_L)) * frame_.anterior_L;
  std::vector<std::vector<double>> radii(kSectors), heights(kSectors);
  const auto collect = [&](bool crowns_only) {
    for (auto& values : radii) values.clear();
    for (std::size_t v = 0; v < jaw.mask.values.size(); ++v) {
      if (jaw.mask.values[v] == 0) continue;
      const Vec3 p_L = jaw.center(v);
      const double height_mm = jaw.height_mm(p_L);
      if (crowns_only && !is_crown(p_L, height_mm)) continue;
      const Vec3 d = p_L - origin_L_;
      const std::size_t at = bin(p_L);
      radii[at].push_back(std::hypot(frame_.left_L.dot(d), frame_.anterior_L.dot(d)));
      if (!crowns_only) heights[at].push_back(height_mm);
    }
  };
  collect(false);
  for (const auto& values : heights)
    highest_mm_.push_back(values.empty() ? std::nan("")
                                         : *std::max_element(values.begin(), values.end()));
  fill_gaps(highest_mm_);
  highest_mm_ = smoothed_values(highest_mm_, 2);
  collect(true);
  std::vector<double> radius_mm;
  radius_mm.reserve(radii.size());
  for (auto& values : radii) radius_mm.push_back(median_or_nan(std::move(values)));
  fill_gaps(radius_mm);
  radius_mm = smoothed_values(radius_mm, 3);
  along_mm_.assign(kSectors, 0.0);
  const double step = 4.0 * std::numbers::pi / 3.0 / double(kSectors - 1);
  for (std::size_t n = 1; n < kSectors; ++n) {
    const double a = radius_mm[n - 1], b = radius_mm[n];
    along_mm_[n] =
        along_mm_[n - 1] + std::sqrt(std::max(0.0, a * a + b * b - 2.0 * a * b * std::cos(step)));
  }
  const double middle = 0.5 * (along_mm_[kSectors / 2 - 1] + along_mm_[kSectors / 2]);
  for (double& value : along_mm_) value -= middle;
}

/// Number of common faces of each pair of parts, and the size of each part.
struct Adjacency {
  std::map<std::int32_t, std::map<std::int32_t, Index>> faces;  ///< In both directions.
  std::map<std::int32_t, Index> voxels, crown_voxels;

  /// The neighbor with the most common faces; 0 if there is none.
  [[nodiscard]] std::int32_t closest(std::int32_t part) const {
    const auto neighbors = faces.find(part);
    if (neighbors == faces.end()) return 0;
    std::int32_t closest = 0;
    Index most = 0;
    for (const auto& [other, count] : neighbors->second)
      if (count > most) {
        most = count;
        closest = other;
      }
    return closest;
  }
  /// Adds `from` to `to`; to 0: removes it.
  void join(std::int32_t from, std::int32_t to) {
    for (const auto& [other, count] : faces[from]) {
      faces[other].erase(from);
      if (to == 0 || other == to) continue;
      faces[to][other] += count;
      faces[other][to] += count;
    }
    faces.erase(from);
    if (to != 0) {
      voxels[to] += voxels[from];
      crown_voxels[to] += crown_voxels[from];
    }
    voxels.erase(from);
    crown_voxels.erase(from);
  }
};

Adjacency adjacency_of(const Jaw& jaw, const Arch& arch) {
  Adjacency found;
  const image::Grid& grid = jaw.parts.grid;
  const std::array<Index, 3> stride{1, grid.size[0], grid.size[0] * grid.size[1]};
  for (Index v = 0; v < grid.voxel_count(); ++v) {
    const std::int32_t part = jaw.parts.values[std::size_t(v)];
    if (part == 0) continue;
    const Vec3 p_L = jaw.center(std::size_t(v));
    ++found.voxels[part];
    if (arch.is_crown(p_L, jaw.height_mm(p_L))) ++found.crown_voxels[part];
    Index rest = v;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const bool is_last = rest % grid.size[axis] + 1 == grid.size[axis];
      rest /= grid.size[axis];
      if (is_last) continue;
      const std::int32_t other = jaw.parts.values[std::size_t(v + stride[axis])];
      if (other == 0 || other == part) continue;
      ++found.faces[part][other];
      ++found.faces[other][part];
    }
  }
  return found;
}

void relabel(Jaw& jaw, std::int32_t from, std::int32_t to) {
  std::replace(jaw.parts.values.begin(), jaw.parts.values.end(), from, to);
}

/// Joins parts that are no tooth of their own with the neighbor that they touch most, the smallest
/// first; removes those without a neighbor.
void join_small_parts(Jaw& jaw, const Arch& arch) {
  constexpr double kMinCrown_mm3 = 30.0;
  const double voxel_mm3 = anatomy::voxel_ml(jaw.mask.grid) * 1e3;
  Adjacency now = adjacency_of(jaw, arch);
  std::map<std::int32_t, std::int32_t> joined;
  const auto is_tooth = [&](std::int32_t part) {
    return double(now.voxels[part]) * voxel_mm3 >= kMinTooth_mm3 &&
           double(now.crown_voxels[part]) * voxel_mm3 >= kMinCrown_mm3;
  };
  std::set<std::pair<Index, std::int32_t>> small;  // By size.
  for (const auto& [part, voxels] : now.voxels)
    if (!is_tooth(part)) small.emplace(voxels, part);
  while (!small.empty()) {
    const std::int32_t part = small.begin()->second;
    small.erase(small.begin());
    const std::int32_t to = now.closest(part);
    if (to != 0) small.erase({now.voxels[to], to});
    now.join(part, to);
    joined[part] = to;
    if (to != 0 && !is_tooth(to)) small.emplace(now.voxels[to], to);
  }
  for (std::int32_t& part : jaw.parts.values)
    for (auto at = joined.find(part); at != joined.end(); at = joined.find(part)) part = at->second;
}

/// Centers and widths of the crowns along the arch.
std::map<std::int32_t, ArchPart> arch_parts(const Jaw& jaw, const Arch& arch) {
  std::map<std::int32_t, std::vector<double>> along;
  for (std::size_t v = 0; v < jaw.parts.values.size(); ++v) {
    if (jaw.parts.values[v] == 0) continue;
    const Vec3 p_L = jaw.center(v);
    if (arch.is_crown(p_L, jaw.height_mm(p_L)))
      along[jaw.parts.values[v]].push_back(arch.along_mm(p_L));
  }
  std::map<std::int32_t, ArchPart> parts;
  for (auto& [part, values] : along) {
    std::sort(values.begin(), values.end());
    const auto at = [&, &list = values](double fraction) {
      return list[std::size_t(fraction * double(list.size() - 1))];
    };
    // A uniform distribution has 90 % of its width between these quantiles.
    const double width_mm = (at(0.95) - at(0.05)) / 0.9;
    parts[part] = {0.5 * (at(0.05) + at(0.95)), width_mm};
  }
  return parts;
}

/// Adjacent parts, each pair once.
std::vector<std::pair<std::int32_t, std::int32_t>> pairs_of(const Adjacency& adjacency) {
  std::vector<std::pair<std::int32_t, std::int32_t>> pairs;
  for (const auto& [part, neighbors] : adjacency.faces)
    for (const auto& [other, count] : neighbors)
      if (part < other && count > 0) pairs.emplace_back(part, other);
  return pairs;
}

/// Joins parts that lie side by side across the arch (cusps, roots).
void join_across(Jaw& jaw, const Arch& arch) {
  constexpr double kOverlap = 0.5;
  for (bool has_changed = true; has_changed;) {
    has_changed = false;
    const auto parts = arch_parts(jaw, arch);
    for (const auto& [first, second] : pairs_of(adjacency_of(jaw, arch))) {
      const auto a = parts.find(first), b = parts.find(second);
      if (a == parts.end() || b == parts.end()) continue;
      const double low = std::max(a->second.first_mm(), b->second.first_mm());
      const double high = std::min(a->second.last_mm(), b->second.last_mm());
      if (high - low < kOverlap * std::min(a->second.width_mm, b->second.width_mm)) continue;
      relabel(jaw, second, first);
      has_changed = true;
      break;
    }
  }
}

NumberedTooth describe_part(const Jaw& jaw, const Arch& arch, std::int32_t part,
                            const ArchPart& along) {
  NumberedTooth tooth;
  std::vector<Vec3> all_L;
  Vec3 crown = Vec3::Zero(), mean = Vec3::Zero();
  double crowns = 0.0;
  for (std::size_t v = 0; v < jaw.parts.values.size(); ++v) {
    if (jaw.parts.values[v] != part) continue;
    const Vec3 p_L = jaw.center(v);
    all_L.push_back(p_L);
    mean += p_L;
    if (!arch.is_crown(p_L, jaw.height_mm(p_L))) continue;
    crown += p_L;
    crowns += 1.0;
  }
  mean /= double(all_L.size());
  tooth.crown_L = crowns > 0.0 ? Vec3(crown / crowns) : mean;
  Mat3 spread = Mat3::Zero();
  for (const Vec3& p_L : all_L) spread += (p_L - mean) * (p_L - mean).transpose();
  tooth.axis_L = symmetric_eigen(spread).vectors.col(2);
  // A molar may be wider than long: then the direction to the crown.
  const Vec3 occlusal_L =
      jaw.jaw == Tooth::kUpper ? Vec3(-jaw.frame.superior_L) : jaw.frame.superior_L;
  constexpr double kUpright = 0.6;
  if (std::abs(tooth.axis_L.dot(occlusal_L)) < kUpright) tooth.axis_L = occlusal_L;
  if (tooth.axis_L.dot(occlusal_L) < 0.0) tooth.axis_L = -tooth.axis_L;
  std::sort(all_L.begin(), all_L.end(), [&](const Vec3& a, const Vec3& b) {
    return tooth.axis_L.dot(a) < tooth.axis_L.dot(b);
  });
  const std::size_t apical = std::max<std::size_t>(1, all_L.size() / 20);
  for (std::size_t n = 0; n < apical; ++n) tooth.apex_L += all_L[n] / double(apical);
  tooth.length_mm = tooth.axis_L.dot(all_L.back() - all_L.front());
  tooth.width_mm = along.width_mm;
  tooth.volume_mm3 = double(all_L.size()) * anatomy::voxel_ml(jaw.mask.grid) * 1e3;
  return tooth;
}

/// The parts of an arch in order, and their numbers.
struct NumberedParts {
  std::vector<std::int32_t> labels;
  std::vector<ArchPart> along;
  std::vector<int> fdi;
};

NumberedParts numbered_parts(const Jaw& jaw, const Arch& arch) {
  const auto parts = arch_parts(jaw, arch);
  std::vector<std::pair<std::int32_t, ArchPart>> ordered(parts.begin(), parts.end());
  std::sort(ordered.begin(), ordered.end(),
            [](const auto& a, const auto& b) { return a.second.center_mm < b.second.center_mm; });
  NumberedParts found;
  for (const auto& [label, place] : ordered) {
    found.labels.push_back(label);
    found.along.push_back(place);
  }
  found.fdi = assign_fdi(found.along, jaw.jaw);
  return found;
}

/// Divides a part across the arch where its crown is thinnest between 30 and 70 % of its width.
void divide_part(Jaw& jaw, const Arch& arch, std::int32_t part, const ArchPart& place,
                 std::int32_t next) {
  constexpr double kBin_mm = 0.5, kFrom = 0.3, kTo = 0.7;
  const auto bins = std::size_t(place.width_mm / kBin_mm) + 1;
  std::vector<double> voxels(bins, 0.0);
  for (std::size_t v = 0; v < jaw.parts.values.size(); ++v) {
    if (jaw.parts.values[v] != part) continue;
    const Vec3 p_L = jaw.center(v);
    const double at = (arch.along_mm(p_L) - place.first_mm()) / kBin_mm;
    if (at >= 0.0 && at < double(bins) && arch.is_crown(p_L, jaw.height_mm(p_L)))
      voxels[std::size_t(at)] += 1.0;
  }
  voxels = smoothed_values(voxels, 1);
  const auto first = voxels.begin() + std::ptrdiff_t(kFrom * double(bins));
  const auto last = voxels.begin() + std::ptrdiff_t(kTo * double(bins)) + 1;
  const double cut_mm =
      place.first_mm() +
      kBin_mm *
          (double(std::min_element(first, std::min(last, voxels.end())) - voxels.begin()) + 0.5);
  for (std::size_t v = 0; v < jaw.parts.values.size(); ++v)
    if (jaw.parts.values[v] == part && arch.along_mm(jaw.center(v)) > cut_mm)
      jaw.parts.values[v] = next;
}

/// Divides wide parts that get no number: crowns that are fused in the map.
NumberedParts divided_parts(Jaw& jaw, const Arch& arch) {
  constexpr double kFused_mm = 9.0;
  constexpr int kRounds = 3;
  NumberedParts found = numbered_parts(jaw, arch);
  for (int round = 0; round < kRounds; ++round) {
    std::int32_t next = *std::max_element(jaw.parts.values.begin(), jaw.parts.values.end());
    bool has_changed = false;
    for (std::size_t n = 0; n < found.fdi.size(); ++n) {
      if (found.fdi[n] != 0 || found.along[n].width_mm < kFused_mm) continue;
      divide_part(jaw, arch, found.labels[n], found.along[n], ++next);
      has_changed = true;
    }
    if (!has_changed) break;
    found = numbered_parts(jaw, arch);
  }
  return found;
}

void number_jaw(Jaw& jaw, const anatomy::Margin& margin, NumberedTeeth& result) {
  const Arch arch(jaw);
  join_small_parts(jaw, arch);
  join_across(jaw, arch);
  const auto [labels, along, fdi] = divided_parts(jaw, arch);
  image::Volume<std::uint8_t> numbers{jaw.mask.grid,
                                      std::vector<std::uint8_t>(jaw.mask.values.size(), 0)};
  for (std::size_t n = 0; n < labels.size(); ++n) {
    if (fdi[n] == 0) continue;
    NumberedTooth tooth = describe_part(jaw, arch, labels[n], along[n]);
    tooth.fdi = fdi[n];
    result.teeth.push_back(tooth);
    for (std::size_t v = 0; v < numbers.values.size(); ++v)
      if (jaw.parts.values[v] == labels[n]) numbers.values[v] = std::uint8_t(fdi[n]);
  }
  image::Volume<std::uint8_t> old = anatomy::cropped(result.numbers, margin);
  for (std::size_t v = 0; v < old.values.size(); ++v)
    if (numbers.values[v] != 0) old.values[v] = numbers.values[v];
  anatomy::paste(old, margin, result.numbers);
}

}  // namespace

NumberedTeeth number_teeth(const anatomy::ToothMap& teeth, const DentalFrame& frame) {
  NumberedTeeth result;
  result.numbers = {teeth.grid, std::vector<std::uint8_t>(teeth.values.size(), 0)};
  for (const Tooth tooth : {Tooth::kUpper, Tooth::kLower}) {
    const auto belongs = [&](std::size_t v) { return teeth.values[v] == tooth; };
    if (std::find(teeth.values.begin(), teeth.values.end(), tooth) == teeth.values.end()) continue;
    const anatomy::Margin margin = anatomy::margin_around(teeth.grid, {2, 2, 2}, belongs);
    Jaw jaw{anatomy::cropped(anatomy::mask_where(teeth.grid, belongs), margin), {}, tooth, frame};
    jaw.parts = split_teeth(jaw.mask, kDynamic_mm);
    number_jaw(jaw, margin, result);
  }
  std::sort(result.teeth.begin(), result.teeth.end(),
            [](const NumberedTooth& a, const NumberedTooth& b) { return a.fdi < b.fdi; });
  result.missing = missing_numbers(result.teeth);
  return result;
}

std::vector<int> missing_numbers(std::span<const NumberedTooth> teeth) {
  std::vector<int> missing;
  for (int quadrant = 1; quadrant <= 4; ++quadrant)
    for (int position = 1; position <= 7; ++position) {
      const int fdi = 10 * quadrant + position;
      if (std::none_of(teeth.begin(), teeth.end(), [&](auto& one) { return one.fdi == fdi; }))
        missing.push_back(fdi);
    }
  return missing;
}

}  // namespace lefort::dental
