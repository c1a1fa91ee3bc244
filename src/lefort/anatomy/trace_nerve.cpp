#include <lefort/anatomy/minimal_path.h>
#include <lefort/anatomy/trace_nerve.h>
#include <lefort/anatomy/voxel_mask.h>
#include <lefort/image/interpolate.h>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>

namespace lefort::anatomy {
namespace {

constexpr double kVoxel_mm = 0.5;
constexpr double kSmoothing_mm = 0.5;
// The mandible reaches so far beyond its landmarks.
constexpr double kAround_mm = 20.0, kMaxExtent_mm = 250.0;
constexpr double kMarrowGap_mm = 3.0;
constexpr double kCourse_mm = 4.0;
constexpr double kForamenReach_mm = 7.0;
constexpr double kSymphysisToForamen_mm = 27.0;
constexpr double kForamenHeight_mm = 14.0;
constexpr double kOutsideMandible_hu = -200.0;

/// One half of the mandible on a grid along the directions of the head.
struct HalfMandible {
  image::ScalarVolume hu;  ///< Smoothed.
  Mask bone;               ///< With its marrow.
  Mask surface;            ///< Voxels of `bone` next to others.
};

/// A grid around the landmarks of the side; i is lateral, j anterior, k superior.
image::Grid grid_of(const MandibleSide& side) {
  Mat3 direction;
  direction << side.lateral_L, side.anterior_L, side.superior_L;
  // The directions of the left side are left-handed; a grid needs a rotation.
  if (direction.determinant() < 0.0) direction.col(0) *= -1.0;
  Box3 box;
  for (const Vec3& p_L : {side.pogonion_L, side.gonion_L, side.condylion_L})
    box.extend(Vec3(direction.transpose() * p_L));
  for (const auto& p_L : {side.mandibular_foramen_L, side.mental_foramen_L})
    if (p_L) box.extend(Vec3(direction.transpose() * *p_L));
  for (const Vec3& p_L : side.points_L) box.extend(Vec3(direction.transpose() * p_L));
  const Vec3 low = box.min() - Vec3::Constant(kAround_mm);
  const Vec3 extent = box.max() + Vec3::Constant(kAround_mm) - low;
  image::Grid grid;
  grid.direction = direction;
  grid.spacing_mm = Vec3::Constant(kVoxel_mm);
  grid.origin_L = direction * low;
  for (std::size_t axis = 0; axis < 3; ++axis)
    grid.size[axis] = Index(std::ceil(extent[Index(axis)] / kVoxel_mm)) + 1;
  return grid;
}

HalfMandible half_mandible(const image::CtVolume& ct, const LabelMap& labels,
                           const MandibleSide& side) {
  HalfMandible half;
  const image::Grid grid = grid_of(side);
  half.hu = {grid, std::vector<float>(std::size_t(grid.voxel_count()))};
  parallel_for(grid.voxel_count(), [&](Index v) {
    half.hu.values[std::size_t(v)] =
        float(image::interpolate(ct, grid.center_L(v), kOutsideMandible_hu));
  });
  half.hu = smoothed(std::move(half.hu), kSmoothing_mm);
  const Mask labeled = mask_where(grid, [&](std::size_t v) {
    const Vec3 at = labels.grid.index_V(grid.center_L(Index(v)));
    const auto i = Index(std::lround(at.x())), j = Index(std::lround(at.y())),
               k = Index(std::lround(at.z()));
    return labels.grid.contains(i, j, k) && labels.at(i, j, k) == Tissue::kMandible;
  });
  half.bone = closed(labeled, kMarrowGap_mm);
  // Marrow that the bone encloses.
  const Components outside = connected_components(
      mask_where(grid, [&](std::size_t v) { return half.bone.values[v] == 0; }), Neighbors::kFaces);
  const std::int32_t around = outside.largest();
  for (std::size_t v = 0; v < half.bone.values.size(); ++v)
    if (outside.component_of.values[v] != around) half.bone.values[v] = 1;
  const Mask inner = eroded(half.bone, kVoxel_mm);
  half.surface = mask_where(
      grid, [&](std::size_t v) { return half.bone.values[v] != 0 && inner.values[v] == 0; });
  return half;
}

/// Extent of the bone in a slab of one voxel.
struct Section {
  Index voxels = 0;
  Vec3 mean_L = Vec3::Zero();
  double lowest_mm = std::numeric_limits<double>::infinity();  ///< Along superior.
  double anterior_mm = -std::numeric_limits<double>::infinity();
  double posterior_mm = std::numeric_limits<double>::infinity();
};

/// \param accepts  whether a voxel of the bone counts, by its position.
template <class Accepts>
Section section_of(const HalfMandible& half, const MandibleSide& side, const Accepts& accepts) {
  Section section;
  for (std::size_t v = 0; v < half.bone.values.size(); ++v) {
    if (half.bone.values[v] == 0) continue;
    const Vec3 p_L = half.bone.grid.center_L(Index(v));
    if (!accepts(p_L)) continue;
    ++section.voxels;
    section.mean_L += p_L;
    section.lowest_mm = std::min(section.lowest_mm, side.superior_L.dot(p_L));
    section.anterior_mm = std::max(section.anterior_mm, side.anterior_L.dot(p_L));
    section.posterior_mm = std::min(section.posterior_mm, side.anterior_L.dot(p_L));
  }
  if (section.voxels > 0) section.mean_L /= double(section.voxels);
  return section;
}

/// The voxel of the surface that is closest to a point; the point itself if there is none.
Vec3 on_surface(const HalfMandible& half, const Vec3& p_L) {
  Vec3 closest_L = p_L;
  double min_mm = std::numeric_limits<double>::infinity();
  for (std::size_t v = 0; v < half.surface.values.size(); ++v) {
    if (half.surface.values[v] == 0) continue;
    const Vec3 q_L = half.surface.grid.center_L(Index(v));
    if ((q_L - p_L).norm() < min_mm) {
      min_mm = (q_L - p_L).norm();
      closest_L = q_L;
    }
  }
  return closest_L;
}

Result<Vec3> missing_bone(const char* where) {
  return fail(ErrorCode::kAnatomyMissing,
              fmt::format("the mandible has no bone {}: check its label and the landmarks Pg, Go "
                          "and Co",
                          where));
}

/// Behind the middle between the borders of the ramus, on its medial surface.
Result<Vec3> expected_mandibular_foramen(const HalfMandible& half, const MandibleSide& side) {
  constexpr double kHeight = 0.4, kSlab_mm = 1.0;
  const Vec3 level_L = side.gonion_L + kHeight * (side.condylion_L - side.gonion_L);
  const Section ramus = section_of(half, side, [&](const Vec3& p_L) {
    return std::abs(side.superior_L.dot(p_L - level_L)) < kSlab_mm &&
           std::abs(side.anterior_L.dot(p_L - level_L)) < 30.0;
  });
  if (ramus.voxels == 0) return missing_bone("at the ramus");
  constexpr double kBehindMiddle_mm = 3.0;
  const double middle_mm = 0.5 * (ramus.anterior_mm + ramus.posterior_mm) - kBehindMiddle_mm;
  const Section strip = section_of(half, side, [&](const Vec3& p_L) {
    return std::abs(side.superior_L.dot(p_L - level_L)) < kSlab_mm &&
           std::abs(side.anterior_L.dot(p_L) - middle_mm) < kSlab_mm;
  });
  if (strip.voxels == 0) return missing_bone("at the ramus");
  constexpr double kRamus_mm = 6.0;
  return on_surface(half, strip.mean_L - kRamus_mm * side.lateral_L);
}

/// The slab of the body normal to the line from the symphysis to the gonion.
Section body_section(const HalfMandible& half, const MandibleSide& side, double from_symphysis_mm,
                     double below_mm) {
  Vec3 along_L = side.gonion_L - side.pogonion_L;
  along_L -= side.superior_L.dot(along_L) * side.superior_L;
  along_L.normalize();
  return section_of(half, side, [&](const Vec3& p_L) {
    return std::abs(along_L.dot(p_L - side.pogonion_L) - from_symphysis_mm) < 2.0 * kVoxel_mm &&
           side.lateral_L.dot(p_L - side.pogonion_L) > 4.0 && side.superior_L.dot(p_L) < below_mm;
  });
}

/// The point of the body at a height above its lower border, in the middle of the bone.
Result<Vec3> middle_of_body(const HalfMandible& half, const MandibleSide& side,
                            double from_symphysis_mm, double height_mm) {
  const double any = std::numeric_limits<double>::infinity();
  const Section whole = body_section(half, side, from_symphysis_mm, any);
  if (whole.voxels == 0) return missing_bone("in the body");
  const Section lower =
      body_section(half, side, from_symphysis_mm, whole.lowest_mm + height_mm + 5.0);
  return Vec3(lower.mean_L +
              (whole.lowest_mm + height_mm - side.superior_L.dot(lower.mean_L)) * side.superior_L);
}

/// From posterior to anterior.
Result<std::vector<Vec3>> expected_course(const HalfMandible& half, const MandibleSide& side) {
  std::vector<Vec3> course_L;
  if (side.mandibular_foramen_L) {
    course_L.push_back(*side.mandibular_foramen_L);
  } else {
    LEFORT_TRY(const Vec3 start_L, expected_mandibular_foramen(half, side));
    course_L.push_back(start_L);
  }
  Vec3 along_L = side.gonion_L - side.pogonion_L;
  along_L -= side.superior_L.dot(along_L) * side.superior_L;
  const double body_mm = along_L.norm();
  for (const auto& [fraction, height_mm] : {std::pair{0.78, 9.0}, {0.6, 8.0}}) {
    LEFORT_TRY(const Vec3 p_L, middle_of_body(half, side, fraction * body_mm, height_mm));
    course_L.push_back(p_L);
  }
  if (side.mental_foramen_L) {
    course_L.push_back(*side.mental_foramen_L);
  } else {
    LEFORT_TRY(const Vec3 p_L,
               middle_of_body(half, side, kSymphysisToForamen_mm, kForamenHeight_mm));
    constexpr double kBody_mm = 8.0;
    course_L.push_back(on_surface(half, p_L + kBody_mm * side.lateral_L));
  }
  return course_L;
}

double distance_from(std::span<const Vec3> course_L, const Vec3& p_L) {
  double min_mm = std::numeric_limits<double>::infinity();
  for (std::size_t n = 1; n < course_L.size(); ++n) {
    const Vec3 edge = course_L[n] - course_L[n - 1];
    const double t =
        std::clamp(edge.dot(p_L - course_L[n - 1]) / std::max(edge.squaredNorm(), 1e-9), 0.0, 1.0);
    min_mm = std::min(min_mm, (course_L[n - 1] + t * edge - p_L).norm());
  }
  return min_mm;
}

/// A percentile of the CT numbers in a set of voxels.
double percentile_in(const HalfMandible& half, const Mask& set, double fraction) {
  std::vector<float> values;
  for (std::size_t v = 0; v < set.values.size(); ++v)
    if (set.values[v] != 0) values.push_back(half.hu.values[v]);
  if (values.empty()) return 0.0;
  const auto at = values.begin() + std::ptrdiff_t(fraction * double(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return double(*at);
}

bool is_at_border(const image::Grid& grid, Index v) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Index at = v % grid.size[axis];
    v /= grid.size[axis];
    if (at == 0 || at == grid.size[axis] - 1) return true;
  }
  return false;
}

/// Dark lines (\cite sato1998), sigma^2 sqrt(l2 l3) with the two largest eigenvalues of the Hessian
/// of the image after a Gaussian of `sigma_mm`, where both are positive; otherwise 0.
image::ScalarVolume dark_lines(const HalfMandible& half, double sigma_mm) {
  const image::Grid& grid = half.hu.grid;
  // half.hu is smoothed already.
  const image::ScalarVolume h = smoothed(
      half.hu, std::sqrt(std::max(0.0, sigma_mm * sigma_mm - kSmoothing_mm * kSmoothing_mm)));
  image::ScalarVolume response{grid, std::vector<float>(h.values.size(), 0.0F)};
  const std::array<Index, 3> stride{1, grid.size[0], grid.size[0] * grid.size[1]};
  const double scale = sigma_mm * sigma_mm / (kVoxel_mm * kVoxel_mm);
  parallel_for(grid.voxel_count(), [&](Index v) {
    if (half.bone.values[std::size_t(v)] == 0 || is_at_border(grid, v)) return;
    const auto at = [&](Index w) { return double(h.values[std::size_t(w)]); };
    Mat3 hessian;
    for (int a = 0; a < 3; ++a) {
      const Index n = stride[std::size_t(a)];
      hessian(a, a) = scale * (at(v + n) - 2.0 * at(v) + at(v - n));
      for (int b = 0; b < a; ++b) {
        const Index m = stride[std::size_t(b)];
        hessian(a, b) = hessian(b, a) =
            0.25 * scale * (at(v + n + m) - at(v + n - m) - at(v - n + m) + at(v - n - m));
      }
    }
    Eigen::SelfAdjointEigenSolver<Mat3> eigen;
    eigen.computeDirect(hessian, Eigen::EigenvaluesOnly);
    const double middle = eigen.eigenvalues()[1], largest = eigen.eigenvalues()[2];
    if (middle > 0.0) response.values[std::size_t(v)] = float(std::sqrt(middle * largest));
  });
  return response;
}

image::ScalarVolume speed_in(const HalfMandible& half, std::span<const Vec3> course_L) {
  constexpr double kInner_mm = 2.0, kCanalFraction = 0.1, kScale = 0.35;
  constexpr double kLineSigma_mm = 1.0, kLineFraction = 0.5;
  // Fatty marrow has -100 HU; what is darker is a streak beside metal, or air.
  constexpr double kMarrow_hu = -120.0, kShadow_hu = 80.0;
  const double low_hu = percentile_in(half, eroded(half.bone, kInner_mm), kCanalFraction);
  const double high_hu = std::max(percentile_in(half, half.surface, 0.5), low_hu + 100.0);
  const double scale_hu = kScale * (high_hu - low_hu);
  const double line_hu = kLineFraction * (high_hu - low_hu);
  const image::ScalarVolume lines = dark_lines(half, kLineSigma_mm);
  image::ScalarVolume speed{half.hu.grid, std::vector<float>(half.hu.values.size(), 0.0F)};
  parallel_for(half.hu.grid.voxel_count(), [&](Index v) {
    if (half.bone.values[std::size_t(v)] == 0) return;
    const double h = double(half.hu.values[std::size_t(v)]);
    const double denser = std::max({0.0, (h - low_hu) / scale_hu, (kMarrow_hu - h) / kShadow_hu});
    const double d = distance_from(course_L, half.hu.grid.center_L(v)) / kCourse_mm;
    const double line = std::min(1.0, double(lines.values[std::size_t(v)]) / line_hu);
    speed.values[std::size_t(v)] =
        float((0.05 + 0.95 * std::exp(-0.5 * d * d)) * (0.05 + 0.95 * line) /
              (1.0 + denser * denser * denser * denser));
  });
  return speed;
}

/// Time that the front needs for 1 mm of the canal; an end away from the expected foramen costs as
/// much, so that a short path is not preferred.
constexpr double kSlowness = 1.5;

/// Voxels of the surface near an expected foramen from which the bone faces a direction, with the
/// cost of their distance from it.
std::vector<FrontSource> surface_near(const HalfMandible& half, const Vec3& p_L,
                                      const Vec3& outward_L) {
  constexpr double kProbe_mm = 2.0;
  const image::Grid& grid = half.bone.grid;
  std::vector<FrontSource> voxels;
  for (std::size_t v = 0; v < half.surface.values.size(); ++v) {
    if (half.surface.values[v] == 0) continue;
    const Vec3 q_L = grid.center_L(Index(v));
    if ((q_L - p_L).norm() > kForamenReach_mm) continue;
    const Vec3 at = grid.index_V(q_L + kProbe_mm * outward_L);
    const auto i = Index(std::lround(at.x())), j = Index(std::lround(at.y())),
               k = Index(std::lround(at.z()));
    if (grid.contains(i, j, k) && half.bone.at(i, j, k) != 0) continue;
    voxels.push_back({Index(v), float(kSlowness * (q_L - p_L).norm())});
  }
  return voxels;
}

/// The voxel of the bone closest to a given point.
Result<Index> voxel_at(const HalfMandible& half, const Vec3& p_L) {
  constexpr double kNear_mm = 3.0;
  Index closest = -1;
  double min_mm = kNear_mm;
  for (std::size_t v = 0; v < half.bone.values.size(); ++v) {
    if (half.bone.values[v] == 0) continue;
    const double d_mm = (half.bone.grid.center_L(Index(v)) - p_L).norm();
    if (d_mm <= min_mm && (d_mm < min_mm || closest < 0)) {
      min_mm = d_mm;
      closest = Index(v);
    }
  }
  if (closest < 0)
    return fail(ErrorCode::kAnatomyMissing,
                fmt::format("the given point ({:.1f}, {:.1f}, {:.1f}) of the canal is more than "
                            "{:g} mm from the mandible",
                            p_L.x(), p_L.y(), p_L.z(), kNear_mm));
  return closest;
}

/// Voxels that the path must pass: sets at its ends, single ones between.
Result<std::vector<std::vector<FrontSource>>> stations(const HalfMandible& half,
                                                       const MandibleSide& side,
                                                       std::span<const Vec3> course_L) {
  std::vector<std::vector<FrontSource>> all;
  if (side.mandibular_foramen_L) {
    LEFORT_TRY(const Index v, voxel_at(half, *side.mandibular_foramen_L));
    all.push_back({{v}});
  } else {
    all.push_back(surface_near(half, course_L.front(), -side.lateral_L));
  }
  for (const Vec3& p_L : side.points_L) {
    LEFORT_TRY(const Index v, voxel_at(half, p_L));
    all.push_back({{v}});
  }
  if (side.mental_foramen_L) {
    LEFORT_TRY(const Index v, voxel_at(half, *side.mental_foramen_L));
    all.push_back({{v}});
  } else {
    all.push_back(surface_near(half, course_L.back(), side.lateral_L));
  }
  return all;
}

/// The voxel of a set with the smallest sum of arrival time and cost; -1 if none is reached.
Index best_end(const image::ScalarVolume& times, std::span<const FrontSource> voxels) {
  Index best = -1;
  float least = kNeverReached;
  for (const auto& [v, cost] : voxels)
    if (times.values[std::size_t(v)] + cost < least) {
      least = times.values[std::size_t(v)] + cost;
      best = v;
    }
  return best;
}

/// Paths from station to station, joined.
std::vector<Vec3> path_through(const image::ScalarVolume& speed,
                               const std::vector<std::vector<FrontSource>>& through) {
  std::vector<Vec3> path_L;
  for (std::size_t n = 1; n < through.size(); ++n) {
    const image::ScalarVolume times = arrival_times(speed, through[n - 1]);
    const Index end = best_end(times, through[n]);
    const std::vector<Vec3> part_L = minimal_path(times, end);
    if (part_L.empty()) return {};
    path_L.insert(path_L.end(), part_L.begin() + (path_L.empty() ? 0 : 1), part_L.end());
  }
  return path_L;
}

/// Mean CT number 3 mm from a point of the line, in the directions normal to it.
double density_around(const HalfMandible& half, const Vec3& p_L, const Vec3& along_L) {
  constexpr int kDirections = 12;
  constexpr double kRadius_mm = 3.0;
  const Vec3 first = along_L.unitOrthogonal(), second = along_L.cross(first);
  double sum = 0.0;
  for (int n = 0; n < kDirections; ++n) {
    const double angle = 2.0 * 3.14159265358979 * double(n) / kDirections;
    sum += image::interpolate(
        half.hu, p_L + kRadius_mm * (std::cos(angle) * first + std::sin(angle) * second),
        kOutsideMandible_hu);
  }
  return sum / kDirections;
}

void describe_line(const HalfMandible& half, NerveCanal& canal) {
  std::size_t visible = 0;
  for (std::size_t n = 0; n < canal.line_L.size(); ++n) {
    const std::size_t from = n > 0 ? n - 1 : 0, to = std::min(n + 1, canal.line_L.size() - 1);
    const Vec3 along_L = (canal.line_L[to] - canal.line_L[from]).normalized();
    canal.hu.push_back(image::interpolate(half.hu, canal.line_L[n], kOutsideMandible_hu));
    if (canal.hu.back() < density_around(half, canal.line_L[n], along_L)) ++visible;
  }
  canal.visible_fraction = double(visible) / double(canal.line_L.size());
}

}  // namespace

Result<NerveCanal> trace_nerve(const image::CtVolume& ct, const LabelMap& labels,
                               const MandibleSide& side) {
  const image::Grid grid = grid_of(side);
  if (double(*std::max_element(grid.size.begin(), grid.size.end())) * kVoxel_mm > kMaxExtent_mm)
    return fail(ErrorCode::kAnatomyMissing,
                "the landmarks and points of the canal lie too far from each other for a mandible: "
                "they may be of another scan");
  const HalfMandible half = half_mandible(ct, labels, side);
  LEFORT_TRY(const std::vector<Vec3> course_L, expected_course(half, side));
  LEFORT_TRY(const auto through, stations(half, side, course_L));
  const std::vector<Vec3> path_L = path_through(speed_in(half, course_L), through);
  if (path_L.size() < 2) return tl::unexpected(missing_bone("between the foramina").error());
  constexpr double kLineSmoothing_mm = 1.5, kLineSpacing_mm = 0.5;
  NerveCanal canal;
  canal.line_L = smoothed_path(path_L, kLineSmoothing_mm, kLineSpacing_mm);
  describe_line(half, canal);
  return canal;
}

}  // namespace lefort::anatomy
