#include <lefort/anatomy/find_occlusal_planes.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace lefort::anatomy {
namespace {

// Half the width of a dental arch with its alveolar process, and its depth from the lips to the
// last molars; adults have about 32 and 50 mm.
constexpr double kArchHalfWidth_mm = 30.0;
constexpr double kArchDepth_mm = 50.0;
// From the top of the head to below the chin.
constexpr double kHead_mm = 240.0;
// Distance of the points at which bone is sampled.
constexpr double kSample_mm = 1.0;
// CT numbers above that of enamel count as enamel: metal.
constexpr double kMaxDensity_hu = 2500.0;
// Planes: pitch and roll of the head.
constexpr int kPitchSteps = 6, kRollSteps = 3;
constexpr double kStep_deg = 4.0;
// The arches on both sides of the gap: their densest planes lie this far from it.
constexpr int kNear_mm = 3, kFar_mm = 22;
// Least sum over the planes on both sides: 150 mm^2 of cortical bone.
constexpr double kMinArch_hu_mm2 = 150.0 * 1000.0;
// Minimum contrast of a gap, maximum number of candidates, and minimum distance between two.
constexpr double kMinContrast = 0.4;
constexpr std::size_t kMaxPlanes = 4;
constexpr double kApart_mm = 6.0;
// Enamel and metal: denser than cortical bone; the least volume of an arch's enamel, and half the
// height of both crowns.
constexpr double kEnamel_hu = 1700.0;
constexpr double kMinEnamel_mm3 = 500.0;
constexpr double kCrowns_mm = 12.0;
// A head is tilted less than 35 degrees.
constexpr double kMinUpright = 0.82;

struct Sample {
  Vec3 p_L;
  double density_hu;
  double enamel_mm3;
};

/// Bone of the head at points about kSample_mm apart.
std::vector<Sample> samples_of(const image::CtVolume& ct, const Mask& bone, double bone_hu) {
  const image::Grid& grid = ct.grid;
  std::array<Index, 3> step{};
  double volume_mm3 = 1.0;  // Of one sample.
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double spacing_mm = grid.spacing_mm[Index(axis)];
    step[axis] = std::max<Index>(1, Index(std::lround(kSample_mm / spacing_mm)));
    volume_mm3 *= double(step[axis]) * spacing_mm;
  }
  std::vector<Sample> samples;
  double top_mm = -std::numeric_limits<double>::infinity();
  for (Index k = 0; k < grid.size[2]; k += step[2])
    for (Index j = 0; j < grid.size[1]; j += step[1])
      for (Index i = 0; i < grid.size[0]; i += step[0]) {
        if (bone.at(i, j, k) == 0) continue;
        const Vec3 p_L = grid.point_L({double(i), double(j), double(k)});
        const double density = std::clamp(double(ct.at(i, j, k)) - bone_hu, 0.0, kMaxDensity_hu);
        const double enamel_mm3 = double(ct.at(i, j, k)) >= kEnamel_hu ? volume_mm3 : 0.0;
        samples.push_back({p_L, density * volume_mm3, enamel_mm3});
        top_mm = std::max(top_mm, p_L.z());
      }
  std::erase_if(samples, [&](const Sample& s) { return s.p_L.z() < top_mm - kHead_mm; });
  return samples;
}

double quantile(std::vector<double> values, double fraction) {
  const auto at = values.begin() + std::ptrdiff_t(fraction * double(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// The most anterior bone in the middle of the head, without single voxels.
Vec3 front_of(const std::vector<Sample>& samples) {
  constexpr double kSingleVoxels = 0.002;
  constexpr double kMiddle = 0.5;
  std::array<std::vector<double>, 3> along;
  for (const Sample& sample : samples)
    for (std::size_t axis = 0; axis < 3; ++axis) along[axis].push_back(sample.p_L[Index(axis)]);
  return {quantile(along[0], kMiddle), quantile(along[1], kSingleVoxels),
          quantile(along[2], kMiddle)};
}

/// Sums of density over planes 1 mm apart.
struct Profile {
  double first_mm = 0.0;
  std::vector<double> sum_hu_mm2;

  [[nodiscard]] double max_of(int from, int to) const {
    double most = 0.0;
    for (int n = std::max(from, 0); n <= std::min(to, int(sum_hu_mm2.size()) - 1); ++n)
      most = std::max(most, sum_hu_mm2[std::size_t(n)]);
    return most;
  }
};

Profile profile_along(const std::vector<Sample>& samples, const Vec3& normal_L) {
  Profile profile;
  std::vector<double> heights;
  heights.reserve(samples.size());
  for (const Sample& sample : samples) heights.push_back(normal_L.dot(sample.p_L));
  const auto [low, high] = std::minmax_element(heights.begin(), heights.end());
  profile.first_mm = *low;
  // Each sample is divided between two planes, so that their sums do not depend on its phase.
  std::vector<double> sums(std::size_t(*high - *low) + 2, 0.0);
  for (std::size_t n = 0; n < samples.size(); ++n) {
    const double at = heights[n] - *low;
    const auto below = std::size_t(at);
    sums[below] += samples[n].density_hu * (1.0 - (at - double(below)));
    sums[below + 1] += samples[n].density_hu * (at - double(below));
  }
  profile.sum_hu_mm2 = sums;
  for (std::size_t n = 1; n + 1 < sums.size(); ++n)
    profile.sum_hu_mm2[n] = 0.25 * sums[n - 1] + 0.5 * sums[n] + 0.25 * sums[n + 1];
  return profile;
}

/// Adds the valleys of a profile.
void add_valleys(const Profile& profile, const OcclusalPlane& tilted,
                 std::vector<OcclusalPlane>& planes) {
  const auto& sums = profile.sum_hu_mm2;
  for (int n = 1; n + 1 < int(sums.size()); ++n) {
    const double here = sums[std::size_t(n)];
    if (here > sums[std::size_t(n) - 1] || here >= sums[std::size_t(n) + 1]) continue;
    int first = n;  // Of equal sums: where the mouth is open, the middle of the gap.
    while (first > 0 && sums[std::size_t(first) - 1] == here) --first;
    const double arch = std::min(profile.max_of(first - kFar_mm, first - kNear_mm),
                                 profile.max_of(n + kNear_mm, n + kFar_mm));
    if (arch < kMinArch_hu_mm2 || 1.0 - here / arch < kMinContrast) continue;
    OcclusalPlane plane = tilted;
    plane.offset_mm = profile.first_mm + 0.5 * double(first + n);
    plane.contrast = 1.0 - here / arch;
    planes.push_back(plane);
  }
}

/// The plane z = a + b x + c y through enamel, fitted by least squares to what lies within
/// kCrowns_mm of the plane before; adds it to the planes.
void add_plane_of_enamel(const std::vector<Sample>& samples, OcclusalPlane plane,
                         std::vector<OcclusalPlane>& planes) {
  constexpr int kIterations = 8;
  std::vector<Sample> enamel = samples;
  std::erase_if(enamel, [](const Sample& sample) { return sample.enamel_mm3 == 0.0; });
  if (enamel.empty()) return;
  std::vector<double> z;
  z.reserve(enamel.size());
  for (const Sample& sample : enamel) z.push_back(sample.p_L.z());
  Vec3 fit(quantile(z, 0.5), 0.0, 0.0);  // a, b, c; x and y relative to the front.
  double limit_mm = 2.0 * kCrowns_mm;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    Mat3 matrix = 1e-9 * Mat3::Identity();
    Vec3 right = Vec3::Zero();
    double found_mm3 = 0.0;
    for (const Sample& sample : enamel) {
      const Vec3 row(1.0, sample.p_L.x() - plane.front_L.x(), sample.p_L.y() - plane.front_L.y());
      if (std::abs(row.dot(fit) - sample.p_L.z()) > limit_mm) continue;
      matrix += sample.enamel_mm3 * row * row.transpose();
      right += sample.enamel_mm3 * row * sample.p_L.z();
      found_mm3 += sample.enamel_mm3;
    }
    if (found_mm3 < kMinEnamel_mm3) return;
    fit = matrix.ldlt().solve(right);
    limit_mm = kCrowns_mm;
  }
  plane.normal_L = Vec3(-fit[1], -fit[2], 1.0).normalized();
  plane.offset_mm = plane.normal_L.dot(Vec3(plane.front_L.x(), plane.front_L.y(), fit[0]));
  plane.contrast = 1.0;
  plane.is_of_enamel = true;
  if (plane.normal_L.z() > kMinUpright) planes.push_back(plane);
}

}  // namespace

bool OcclusalPlane::is_in_arch_column(const Vec3& p_L, double margin_mm) const {
  return std::abs(p_L.x() - front_L.x()) < kArchHalfWidth_mm + margin_mm &&
         p_L.y() < front_L.y() + kArchDepth_mm + margin_mm;
}

std::vector<OcclusalPlane> find_occlusal_planes(const image::CtVolume& ct, const Mask& bone,
                                                double bone_hu) {
  std::vector<Sample> samples = samples_of(ct, bone, bone_hu);
  if (samples.empty()) return {};
  OcclusalPlane plane;
  plane.front_L = front_of(samples);
  std::erase_if(samples, [&](const Sample& s) { return !plane.is_in_arch_column(s.p_L); });
  if (samples.empty()) return {};
  std::vector<OcclusalPlane> all;
  add_plane_of_enamel(samples, plane, all);
  for (int pitch = -kPitchSteps; pitch <= kPitchSteps; ++pitch)
    for (int roll = -kRollSteps; roll <= kRollSteps; ++roll) {
      constexpr double kRadians = std::numbers::pi / 180.0;
      plane.normal_L =
          Vec3(std::tan(roll * kStep_deg * kRadians), std::tan(pitch * kStep_deg * kRadians), 1.0)
              .normalized();
      add_valleys(profile_along(samples, plane.normal_L), plane, all);
    }
  std::stable_sort(all.begin(), all.end(), [](const OcclusalPlane& a, const OcclusalPlane& b) {
    return a.contrast > b.contrast;
  });
  // Planes of one gap differ in their tilt; the best of them remains.
  std::vector<OcclusalPlane> planes;
  for (const OcclusalPlane& one : all) {
    const Vec3 middle_L = one.front_L + Vec3(0.0, 0.5 * kArchDepth_mm, 0.0);
    const auto level = [&](const OcclusalPlane& p) {
      return -p.height_mm({middle_L.x(), middle_L.y(), 0.0}) / p.normal_L.z();
    };
    const bool is_new = std::all_of(planes.begin(), planes.end(), [&](const OcclusalPlane& other) {
      return std::abs(level(one) - level(other)) > kApart_mm;
    });
    if (is_new && planes.size() < kMaxPlanes) planes.push_back(one);
  }
  return planes;
}

}  // namespace lefort::anatomy
