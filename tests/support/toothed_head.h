/// \file
/// A synthetic head with enamel, a pharynx and known landmarks, and intraoral scans of its arches.
#pragma once

#include <lefort/anatomy/extract_surface.h>
#include <lefort/anatomy/parametric_head.h>
#include <lefort/core/error.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/plan/landmarks.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "dental/arch.h"

namespace lefort::test {

/// The crowns of both jaws as level-set functions, positive inside [mm]. The lower ones end in the
/// surface of make_arch(); the upper ones begin at the same surface, moved to superior.
class MadeCrowns {
 public:
  MadeCrowns() : height_mm_(kSide * kSide, NAN), away_mm_(kSide * kSide, NAN) {
    ArchShape shape{.half_width_mm = 28.0, .length_mm = 40.0, .seed = 3.0, .step_mm = 0.15};
    const geometry::TriangleMesh arch = make_arch(shape);
    const int across = int(std::ceil(2.0 * kHalf_mm / shape.step_mm));
    for (std::size_t v = 0; v < arch.vertices.size(); ++v) {
      const Vec3 p_L = arch.vertices[v] + kOrigin_L;
      const double offset = -kHalf_mm + 2.0 * kHalf_mm * double(int(v) % (across + 1)) / across;
      const std::size_t at = cell(p_L.x(), p_L.y());
      height_mm_[at] = p_L.z();
      away_mm_[at] = std::abs(offset);
    }
  }

  [[nodiscard]] double lower(const Vec3& p_L) const {
    const std::size_t at = cell(p_L.x(), p_L.y());
    if (std::isnan(height_mm_[at])) return kOutside_mm;
    return std::min({height_mm_[at] - p_L.z(), p_L.z() - kOrigin_L.z(), kHalf_mm - away_mm_[at]});
  }
  [[nodiscard]] double upper(const Vec3& p_L) const {
    const std::size_t at = cell(p_L.x(), p_L.y());
    if (std::isnan(height_mm_[at])) return kOutside_mm;
    const double surface = height_mm_[at] + kOpen_mm;
    return std::min({p_L.z() - surface, kOrigin_L.z() + kOpen_mm + 13.0 - p_L.z(),
                     kHalf_mm - 1.0 - away_mm_[at]});
  }
  /// Whether a point lies where the crowns are, or between them.
  [[nodiscard]] bool is_near(const Vec3& p_L) const {
    return p_L.z() > kOrigin_L.z() - 1.0 && p_L.z() < kOrigin_L.z() + kOpen_mm + 14.0 &&
           p_L.y() < kOrigin_L.y() + 46.0 && p_L.y() > kOrigin_L.y() - 6.0 &&
           std::abs(p_L.x()) < 36.0;
  }

  /// Distance of the lower arch from its occlusion.
  static constexpr double kOpen_mm = 3.0;

 private:
  static constexpr double kHalf_mm = 4.5, kCell_mm = 0.3, kOutside_mm = -2.0;
  static constexpr int kSide = 260;
  static inline const Vec3 kOrigin_L{0.0, -92.0, -58.0};

  static std::size_t cell(double x, double y) {
    const int i = std::clamp(int(std::floor((x + 39.0) / kCell_mm)), 0, kSide - 1);
    const int j = std::clamp(int(std::floor((y + 102.0) / kCell_mm)), 0, kSide - 1);
    return std::size_t(j) * kSide + std::size_t(i);
  }

  std::vector<double> height_mm_, away_mm_;
};

struct ToothedHead {
  anatomy::LabeledScan scan;
  plan::Landmarks landmarks;
  geometry::TriangleMesh upper_L, lower_L;  ///< The arches.
};

/// The surface of the crowns of one jaw.
template <class Level>
Result<geometry::TriangleMesh> surface_of_crowns(const Level& level_at) {
  image::Grid grid;
  grid.size = {128, 100, 48};
  grid.spacing_mm = Vec3::Constant(0.6);
  grid.origin_L = Vec3(-38.0, -99.0, -61.0);
  image::Volume<float> level{grid, {}};
  for (Index k = 0; k < grid.size[2]; ++k)
    for (Index j = 0; j < grid.size[1]; ++j)
      for (Index i = 0; i < grid.size[0]; ++i)
        level.values.push_back(float(level_at(grid.point_L({double(i), double(j), double(k)}))));
  return anatomy::extract_isosurface(level, {}, Progress::none());
}

/// \param voxel_mm  of the scan.
inline Result<ToothedHead> make_toothed_head(double voxel_mm) {
  const anatomy::ParametricHead head{{}};
  const MadeCrowns crowns;
  ToothedHead made{anatomy::scan_of(head, voxel_mm, 15.0, 5), {}, {}, {}};
  image::CtVolume& ct = made.scan.ct;
  const image::Grid& grid = ct.grid;
  constexpr double kSoft_hu = 40.0, kEnamel_hu = 2600.0, kAirway_mm = 8.0;
  for (Index v = 0; v < grid.voxel_count(); ++v) {
    const Vec3 p_L =
        grid.point_L({double(v % grid.size[0]), double(v / grid.size[0] % grid.size[1]),
                      double(v / (grid.size[0] * grid.size[1]))});
    auto& hu = ct.values[std::size_t(v)];
    auto& label = made.scan.labels.values[std::size_t(v)];
    const auto fraction = [&](double level) {
      return std::clamp(0.5 + level / voxel_mm, 0.0, 1.0);
    };
    const double air =
        p_L.z() < -15.0 ? fraction(kAirway_mm - std::hypot(p_L.x(), p_L.y() + 20.0)) : 0.0;
    if (air > 0.0) hu = std::int16_t(kSoft_hu - 1040.0 * air);
    if (air > 0.5) label = anatomy::Tissue::kAirway;
    if (!crowns.is_near(p_L)) continue;
    const double lower = fraction(crowns.lower(p_L)), upper = fraction(crowns.upper(p_L));
    if (hu > kSoft_hu) hu = std::int16_t(kSoft_hu);
    if (label != anatomy::Tissue::kBackground) label = anatomy::Tissue::kSoftTissue;
    hu = std::int16_t(hu + (kEnamel_hu - hu) * std::max(lower, upper));
    if (lower > 0.5) label = anatomy::Tissue::kMandible;
    if (upper > 0.5) label = anatomy::Tissue::kBone;
  }
  for (auto& hu : ct.values) hu = std::max<std::int16_t>(hu, -1024);
  for (const anatomy::NamedPoint& one : anatomy::true_landmarks(head))
    made.landmarks.push_back({one.name, one.point_L});
  LEFORT_TRY(made.upper_L, surface_of_crowns([&](const Vec3& p_L) { return crowns.upper(p_L); }));
  LEFORT_TRY(made.lower_L, surface_of_crowns([&](const Vec3& p_L) { return crowns.lower(p_L); }));
  return made;
}

}  // namespace lefort::test
