#include <lefort/compare/face_error.h>
#include <lefort/compare/surface_difference.h>
#include <lefort/core/check.h>

#include <cmath>
#include <limits>

namespace lefort::compare {
namespace {

std::vector<ReportedRegion> make_reported_regions() {
  ReportedRegion face{"face", {}}, lower{"lower face", {}};
  for (const FaceRegion region : kFaceRegions) face.contains[std::size_t(region)] = true;
  for (const FaceRegion region : {FaceRegion::kUpperLip, FaceRegion::kLowerLip, FaceRegion::kChin})
    lower.contains[std::size_t(region)] = true;
  std::vector<ReportedRegion> regions{face, lower};
  for (const FaceRegion region : kFaceRegions) {
    regions.push_back({name_of(region), {}});
    regions.back().contains[std::size_t(region)] = true;
  }
  return regions;
}

}  // namespace

std::span<const ReportedRegion> reported_regions() {
  static const std::vector<ReportedRegion> kRegions = make_reported_regions();
  return kRegions;
}

std::vector<RegionError> face_error(const SurfaceDifference& difference,
                                    std::span<const FaceRegion> region_of) {
  LEFORT_CHECK(region_of.size() == difference.signed_mm.size());
  std::vector<RegionError> rows;
  for (const ReportedRegion& region : reported_regions()) {
    const auto is_requested = [&](Index v) {
      return region.contains[std::size_t(region_of[std::size_t(v)])];
    };
    RegionError row{region.name, describe(difference, is_requested),
                    Vec3::Constant(std::numeric_limits<double>::quiet_NaN())};
    Vec3 sum = Vec3::Zero();
    double compared_mm2 = 0.0;
    for (std::size_t v = 0; v < difference.signed_mm.size(); ++v) {
      if (!is_requested(Index(v)) || std::isnan(difference.signed_mm[v])) continue;
      sum += difference.area_mm2[v] * difference.offset_mm[v];
      compared_mm2 += difference.area_mm2[v];
    }
    if (compared_mm2 > 0.0) row.mean_offset_mm = sum / compared_mm2;
    rows.push_back(std::move(row));
  }
  return rows;
}

std::vector<RegionError> face_error(const geometry::TriangleMesh& face_L,
                                    std::span<const FaceRegion> region_of,
                                    const geometry::Bvh& achieved_L) {
  return face_error(measure_difference(face_L, achieved_L), region_of);
}

}  // namespace lefort::compare
