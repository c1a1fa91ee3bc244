#include <lefort/anatomy/implicit_shapes.h>
#include <lefort/anatomy/synthetic_head.h>
#include <lefort/core/parallel.h>

#include <algorithm>
#include <cmath>

namespace lefort::anatomy {
namespace {

using implicit::ellipsoid;
using implicit::join;
using implicit::without;

// Dimensions of the head in L, in mm, similar to an adult's. Left and right differ everywhere.
const Vec3 kCranium(0.0, 5.0, 25.0);
const Vec3 kCraniumOuter(69.0, 88.0, 78.0);
constexpr double kVault_mm = 7.0;  // Thickness of the cranium.
const Vec3 kMaxilla(0.0, -48.0, -38.0);
const Vec3 kNeck(0.0, 25.0, 0.0);
constexpr double kLowest_mm = -112.0;  // Lower end of the scan.

/// Distance to a capsule, positive inside.
double capsule(const Vec3& p, const Vec3& a, const Vec3& b, double radius) {
  const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return radius - (p - a - t * (b - a)).norm();
}

/// Distance to half an elliptic torus in the plane z = `center.z()`, open to posterior.
double arch(const Vec3& p, const Vec3& center, double half_width, double depth, double radius) {
  const Vec3 d = p - center;
  if (d.y() > 0.0) {  // The ends.
    const double x = d.x() > 0.0 ? half_width : -half_width;
    return radius - Vec3(d.x() - x, d.y(), d.z()).norm();
  }
  const Eigen::Vector2d q(d.x() / half_width, d.y() / depth);
  const double k = q.norm();
  const double slope = Eigen::Vector2d(q.x() / half_width, q.y() / depth).norm();
  const double across = slope < 1e-9 ? half_width : k * (k - 1.0) / slope;
  return radius - std::hypot(across, d.z());
}

/// Pseudorandom bits of a number: SplitMix64 (Steele, Lea, Flood 2014).
std::uint64_t splitmix64(std::uint64_t bits) {
  bits += 0x9e3779b97f4a7c15ULL;
  bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9ULL;
  bits = (bits ^ (bits >> 27)) * 0x94d049bb133111ebULL;
  return bits ^ (bits >> 31);
}

/// Approximately Gaussian with standard deviation 1: the sum of four uniform numbers of 16 bits.
double noise(std::uint64_t key) {
  const std::uint64_t bits = splitmix64(key);
  double sum = 0.0;
  for (int part = 0; part < 4; ++part) sum += double((bits >> (16 * part)) & 0xffff) / 65535.0;
  return (sum - 2.0) * std::sqrt(3.0);
}

double hu_at(const Vec3& p, const SyntheticMaterials& materials) {
  using namespace synthetic;
  if (skin(p) <= 0.0) return holder(p) > 0.0 ? materials.holder_hu : materials.air_hu;
  if (airway(p) > 0.0 || sinuses(p) > 0.0) return materials.air_hu;
  if (skull(p) > 0.0 || mandible(p) > 0.0 || column(p) > 0.0) return materials.bone_hu;
  return materials.soft_hu;
}

/// Distance to the closest surface at which the CT number changes.
double to_next_border(const Vec3& p) {
  using namespace synthetic;
  double nearest = 1e9;
  for (const double d :
       {skin(p), holder(p), airway(p), sinuses(p), skull(p), mandible(p), column(p)})
    nearest = std::min(nearest, std::abs(d));
  return nearest;
}

}  // namespace

namespace synthetic {

double skin(const Vec3& p) {
  const double cranium = ellipsoid(p, kCranium, {76.0, 95.0, 85.0});
  const double face = ellipsoid(p, {0.0, -35.0, -55.0}, {66.0, 66.0, 68.0});
  const double nose = ellipsoid(p, {3.0, -100.0, -34.0}, {13.0, 18.0, 20.0});
  // An upright cylinder; the scan truncates the neck.
  const Vec3 in_plane(p.x(), p.y(), 0.0);
  const double column_of_neck = ellipsoid(in_plane, kNeck, {54.0, 58.0, 1.0});
  const double neck = p.z() > -20.0 ? std::min(column_of_neck, -20.0 - p.z()) : column_of_neck;
  return join(join(join(cranium, face, 20.0), nose, 8.0), neck, 20.0);
}

double brain(const Vec3& p) {
  return ellipsoid(p, kCranium, kCraniumOuter - Vec3::Constant(kVault_mm));
}

double skull(const Vec3& p) {
  double shell = std::min(ellipsoid(p, kCranium, kCraniumOuter), -brain(p));
  const Vec3 hole = Vec3(-0.5, -0.8, 0.35).normalized();  // On the patient's right, in front.
  if ((p - kCranium).dot(hole) > 0.0)
    shell = without(shell, 11.0 - (p - kCranium).cross(hole).norm(), 3.0);
  if (p.z() < kCranium.z())  // Foramen magnum.
    shell = without(shell, 13.0 - std::hypot(p.x(), p.y() - 38.0), 3.0);
  const double block = ellipsoid(p, kMaxilla, {38.0, 36.0, 30.0});
  return join(shell, without(block, brain(p), 3.0), 4.0);
}

double mandible(const Vec3& p) {
  const Vec3 chin(-2.0, -35.0, -88.0);  // Right of the midline.
  const double body = arch(p, chin, 38.0, 40.0, 8.0);
  const double left = capsule(p, {36.0, -35.0, -88.0}, {43.0, -18.0, -46.0}, 6.5);
  const double right = capsule(p, {-40.0, -35.0, -88.0}, {-43.0, -18.0, -48.0}, 5.0);
  return join(join(body, left, 4.0), right, 4.0);
}

double column(const Vec3& p) {
  return capsule(p, {0.0, 38.0, -66.0}, {0.0, 38.0, 4.0 * kLowest_mm}, 11.0);
}

double airway(const Vec3& p) {
  const double nostril = capsule(p, {3.0, -130.0, -46.0}, {1.0, -75.0, -45.0}, 4.0);
  const double nose = ellipsoid(p, {0.0, -50.0, -42.0}, {9.0, 38.0, 16.0});
  const double pharynx = capsule(p, {0.0, -10.0, -42.0}, {0.0, -6.0, -92.0}, 9.0);
  return join(join(nostril, nose, 3.0), pharynx, 6.0);
}

double sinuses(const Vec3& p) {
  return std::max(ellipsoid(p, {22.0, -50.0, -38.0}, {10.0, 14.0, 13.0}),
                  ellipsoid(p, {-21.0, -50.0, -40.0}, {8.0, 10.0, 9.0}));
}

double holder(const Vec3& p) {
  const double wall = 3.0 - std::abs(std::hypot(p.x(), p.y() - 5.0) - 112.0);
  return std::min(wall, p.y() - 50.0);
}

}  // namespace synthetic

image::Grid synthetic_grid(double voxel_mm) {
  const Vec3 low(-88.0, -126.0, kLowest_mm);
  const Vec3 high(88.0, 124.0, 118.0);
  image::Grid grid;
  grid.spacing_mm = Vec3::Constant(voxel_mm);
  grid.origin_L = low;
  for (Index axis = 0; axis < 3; ++axis)
    grid.size[std::size_t(axis)] = Index((high[axis] - low[axis]) / voxel_mm) + 1;
  return grid;
}

Tissue synthetic_tissue(const Vec3& p) {
  using namespace synthetic;
  if (skin(p) <= 0.0) return Tissue::kBackground;
  if (airway(p) > 0.0) return Tissue::kAirway;
  if (sinuses(p) > 0.0) return Tissue::kSinus;
  if (mandible(p) > 0.0) return Tissue::kMandible;
  if (skull(p) > 0.0 || column(p) > 0.0) return Tissue::kBone;
  return brain(p) > 0.0 ? Tissue::kBrain : Tissue::kSoftTissue;
}

LabelMap synthetic_labels(const image::Grid& grid) {
  LabelMap labels{grid, std::vector<Tissue>(std::size_t(grid.voxel_count()))};
  parallel_for(grid.size[1] * grid.size[2], [&](Index line) {
    const Index j = line % grid.size[1], k = line / grid.size[1];
    for (Index i = 0; i < grid.size[0]; ++i)
      labels.at(i, j, k) = synthetic_tissue(grid.point_L({double(i), double(j), double(k)}));
  });
  return labels;
}

image::CtVolume synthetic_scan(const image::Grid& grid, const SyntheticMaterials& materials,
                               std::uint64_t seed) {
  constexpr int kSamples = 4;  // Along each axis of a voxel.
  // The distances are exact to first order only, hence the safety factor.
  const double margin_mm = 0.8 * grid.spacing_mm.norm();
  image::CtVolume ct{grid, std::vector<std::int16_t>(std::size_t(grid.voxel_count()))};
  const auto mean_hu = [&](const Vec3& center_V) {
    const Vec3 center_L = grid.point_L(center_V);
    if (to_next_border(center_L) > margin_mm) return hu_at(center_L, materials);
    double sum = 0.0;
    for (int n = 0; n < kSamples * kSamples * kSamples; ++n) {
      const Vec3 cell(n % kSamples, n / kSamples % kSamples, n / (kSamples * kSamples));
      const Vec3 offset = (cell.array() + 0.5) / double(kSamples) - 0.5;
      sum += hu_at(grid.point_L(center_V + offset), materials);
    }
    return sum / double(kSamples * kSamples * kSamples);
  };
  // Far from all borders a run of voxels has one material. A factor of two covers the error of the
  // distances there.
  constexpr Index kRun = 8;
  const double run_mm = 0.5 * double(kRun) * grid.spacing_mm.x() + margin_mm;
  parallel_for(grid.size[1] * grid.size[2], [&](Index line) {
    const Index j = line % grid.size[1], k = line / grid.size[1];
    for (Index run = 0; run < grid.size[0]; run += kRun) {
      const Vec3 middle_L =
          grid.point_L({double(run) + 0.5 * double(kRun - 1), double(j), double(k)});
      const bool is_pure = to_next_border(middle_L) > 2.0 * run_mm;
      for (Index i = run; i < std::min(run + kRun, grid.size[0]); ++i) {
        const auto key = splitmix64(seed) + std::uint64_t(grid.offset(i, j, k));
        const double hu =
            (is_pure ? hu_at(middle_L, materials) : mean_hu({double(i), double(j), double(k)})) +
            materials.noise_hu * noise(key);
        ct.at(i, j, k) = std::int16_t(std::lround(std::clamp(hu, -1024.0, 3071.0)));
      }
    }
  });
  return ct;
}

}  // namespace lefort::anatomy
