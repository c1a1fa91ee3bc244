#include <lefort/anatomy/implicit_shapes.h>
#include <lefort/anatomy/parametric_head.h>
#include <lefort/core/parallel.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

namespace lefort::anatomy {
namespace {

constexpr double kHeadAir_hu = -1000.0, kHeadSoft_hu = 40.0, kHeadBone_hu = 1000.0;
// As anatomy/find_teeth.cpp states them.
constexpr double kHeadEnamel_hu = 2500.0, kHeadDentin_hu = 1500.0;
constexpr double kHeadMarrow_hu = 350.0, kHeadCanalWall_hu = 650.0, kHeadCanal_hu = 90.0;
constexpr double kMandibleCortex_mm = 2.0, kMaxillaCortex_mm = 1.5;
constexpr double kCanalRadius_mm = 1.3, kCanalWall_mm = 0.5;
/// Above this the maxilla has no marrow: its walls are thin; mean head.
constexpr double kMaxillaMarrow_mm = -27.0;

double between(double a, double b, double part) { return a + (b - a) * part; }

double distance_to_lines(const std::array<std::vector<Vec3>, 2>& lines, const Vec3& p) {
  double closest = std::numeric_limits<double>::infinity();
  for (const std::vector<Vec3>& line : lines)
    for (std::size_t n = 1; n < line.size(); ++n) {
      const Vec3 edge = line[n] - line[n - 1];
      const double t = std::clamp(edge.dot(p - line[n - 1]) / edge.squaredNorm(), 0.0, 1.0);
      closest = std::min(closest, (line[n - 1] + t * edge - p).norm());
    }
  return closest;
}

/// CT numbers and labels without noise.
class ScannedHead {
 public:
  ScannedHead(const ParametricHead& head, double voxel_mm) : head_(head), voxel_mm_(voxel_mm) {
    if (head.has_dentition()) canals_L_ = {head.canal_L(-1.0), head.canal_L(1.0)};
  }

  /// \returns the CT number and the label.
  [[nodiscard]] std::pair<double, Tissue> at(const Vec3& p_L) const {
    const double skin = head_.skin(p_L);
    if (head_.has_dentition()) return with_teeth(p_L, skin);
    double skull = -1e9, mandible = -1e9;
    if (skin > kDeepest_mm) {
      skull = head_.skull(p_L);
      mandible = head_.mandible(p_L);
    }
    const double bone = std::max(skull, mandible);
    const double hu = kHeadAir_hu + (kHeadSoft_hu - kHeadAir_hu) * fraction(std::max(skin, bone)) +
                      (kHeadBone_hu - kHeadSoft_hu) * fraction(bone);
    return {hu, bone > 0.0   ? (mandible > skull ? Tissue::kMandible : Tissue::kBone)
                : skin > 0.0 ? Tissue::kSoftTissue
                             : Tissue::kBackground};
  }

 private:
  // Bone lies this far outside of the skin at most.
  static constexpr double kDeepest_mm = -6.0;

  [[nodiscard]] double fraction(double level) const {
    return std::clamp(0.5 + level / voxel_mm_, 0.0, 1.0);
  }

  [[nodiscard]] std::pair<double, Tissue> with_teeth(const Vec3& p_L, double skin) const {
    if (skin <= kDeepest_mm) return {kHeadAir_hu, Tissue::kBackground};
    const double skull = head_.skull_bone(p_L), mandible = head_.mandible_bone(p_L);
    const ToothLevels upper = head_.upper_teeth(p_L), lower = head_.lower_teeth(p_L);
    const double tooth = std::max(upper.tooth, lower.tooth);
    const double dentin = std::max(upper.dentin, lower.dentin);
    const double bone = std::max({skull, mandible, tooth}), pharynx = head_.pharynx(p_L);
    double hu = between(kHeadAir_hu, kHeadSoft_hu, fraction(std::max(skin, bone)));
    hu = between(hu, kHeadAir_hu, fraction(pharynx));
    hu = between(hu, inner_hu(p_L, skull, mandible), fraction(std::max(skull, mandible)));
    hu = between(hu, kHeadDentin_hu, fraction(tooth));
    hu += (kHeadEnamel_hu - kHeadDentin_hu) * std::max(0.0, fraction(tooth) - fraction(dentin));
    if (bone > 0.0) {
      const bool is_lower = std::max(mandible, lower.tooth) > std::max(skull, upper.tooth);
      return {hu, is_lower ? Tissue::kMandible : Tissue::kBone};
    }
    if (pharynx > 0.0 && skin > 0.0) return {hu, Tissue::kAirway};
    return {hu, skin > 0.0 ? Tissue::kSoftTissue : Tissue::kBackground};
  }

  /// Cortical bone, marrow, or a canal.
  [[nodiscard]] double inner_hu(const Vec3& p_L, double skull, double mandible) const {
    if (skull > mandible) {
      const double height_mm =
          (head_.X_LH().inverse() * p_L).z() / head_.shape().scale.z() - kMaxillaMarrow_mm;
      const double depth_mm = std::min(skull - kMaxillaCortex_mm, -height_mm);
      return between(kHeadBone_hu, kHeadMarrow_hu, fraction(depth_mm));
    }
    if (mandible < 0.0) return kHeadBone_hu;
    const double marrow =
        between(kHeadBone_hu, kHeadMarrow_hu, fraction(mandible - kMandibleCortex_mm));
    const double r = distance_to_lines(canals_L_, p_L);
    const double wall =
        between(marrow, kHeadCanalWall_hu, fraction(kCanalRadius_mm + kCanalWall_mm - r));
    return between(wall, kHeadCanal_hu, fraction(kCanalRadius_mm - r));
  }

  const ParametricHead& head_;
  double voxel_mm_;
  std::array<std::vector<Vec3>, 2> canals_L_;
};

/// The teeth of a closed jaw near its occlusal surface.
std::vector<Vec3> lower_crowns_L(const ParametricHead& head) {
  constexpr double kStep_mm = 0.35;
  const Vec3 low(-34.0, -100.0, -56.0), high(34.0, -40.0, -46.0);
  std::vector<Vec3> points;
  const auto steps = [&](Index axis) { return Index((high[axis] - low[axis]) / kStep_mm) + 1; };
  for (Index k = 0; k < steps(2); ++k)
    for (Index j = 0; j < steps(1); ++j)
      for (Index i = 0; i < steps(0); ++i) {
        const Vec3 p_L =
            head.X_LH() * head.from_mean(low + kStep_mm * Vec3(double(i), double(j), double(k)));
        if (std::abs(head.lower_teeth(p_L).tooth) < kStep_mm) points.push_back(p_L);
      }
  return points;
}

}  // namespace

std::vector<Vec3> ParametricHead::canal_L(double side) const {
  std::vector<Vec3> line;
  for (const Vec3& mean :
       {Vec3(41.0, -30.0, -38.0), Vec3(44.5, -29.5, -43.0), Vec3(44.0, -31.0, -55.0),
        Vec3(41.0, -36.0, -64.0), Vec3(36.0, -46.0, -71.0), Vec3(30.0, -56.0, -75.0),
        Vec3(25.0, -65.0, -76.5), Vec3(23.0, -69.0, -74.5), Vec3(28.0, -71.0, -72.5)})
    line.push_back(X_LH_ * from_mean(opened(Vec3(side * mean.x(), mean.y(), mean.z()))));
  return line;
}

double opening_with_clearance(const HeadShape& shape, double clearance_mm) {
  HeadShape closed = shape;
  closed.opening_rad = 0.0;
  closed.jaw_offset_mm = closed.jaw_rotation_rad = Vec3::Zero();
  const ParametricHead head(closed);
  const std::vector<Vec3> crowns_L = lower_crowns_L(head);
  const auto is_clear = [&](double opening_rad) {
    HeadShape one = shape;
    one.opening_rad = opening_rad;
    const RigidTransform X_L = ParametricHead(one).X_occlusion_L().inverse();
    return std::none_of(crowns_L.begin(), crowns_L.end(), [&](const Vec3& p_L) {
      return head.upper_teeth(X_L * p_L).tooth > -clearance_mm;
    });
  };
  constexpr double kMax_rad = 0.25;
  constexpr int kBisections = 12;
  double low = 0.0, high = kMax_rad;
  for (int n = 0; n < kBisections; ++n) {
    const double middle = 0.5 * (low + high);
    (is_clear(middle) ? high : low) = middle;
  }
  return high;
}

LabeledScan scan_of(const ParametricHead& head, double voxel_mm, double noise_hu,
                    std::uint64_t seed) {
  const Vec3 low(-96, -150, -125), high(96, 112, 140), middle = head.X_LH().translation();
  return scan_of(head, Box3(low + middle, high + middle), voxel_mm, noise_hu, seed);
}

LabeledScan scan_of(const ParametricHead& head, const Box3& box_L, double voxel_mm, double noise_hu,
                    std::uint64_t seed) {
  image::Grid grid;
  grid.spacing_mm = Vec3::Constant(voxel_mm);
  grid.origin_L = box_L.min();
  for (Index axis = 0; axis < 3; ++axis)
    grid.size[std::size_t(axis)] = Index(box_L.sizes()[axis] / voxel_mm) + 1;
  LabeledScan scan{{grid, std::vector<std::int16_t>(std::size_t(grid.voxel_count()))},
                   {grid, std::vector<Tissue>(std::size_t(grid.voxel_count()))}};
  const ScannedHead scanned(head, voxel_mm);
  parallel_for(grid.size[1] * grid.size[2], [&](Index line) {
    const Index j = line % grid.size[1], k = line / grid.size[1];
    std::mt19937_64 bits(seed * 1000003 + std::uint64_t(line));
    for (Index i = 0; i < grid.size[0]; ++i) {
      const auto [hu, tissue] = scanned.at(grid.point_L({double(i), double(j), double(k)}));
      double noise = -2.0;  // Sum of four uniform numbers: nearly normal, variance 1 / 3.
      for (int n = 0; n < 4; ++n) noise += double(bits() >> 11) * 0x1p-53;
      scan.ct.at(i, j, k) = std::int16_t(std::lround(hu + noise_hu * std::numbers::sqrt3 * noise));
      scan.labels.at(i, j, k) = tissue;
    }
  });
  return scan;
}

}  // namespace lefort::anatomy
