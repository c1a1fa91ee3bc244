#include <lefort/image/interpolate.h>
#include <lefort/predict/jaw_edges.h>
#include <lefort/predict/oral_fissure.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace lefort::predict {
namespace {

// Mouth width ch-ch: 54.5 +- 3.0 mm in men, 50.2 +- 3.5 mm in women (\cite farkas1994). The default
// is their mean; the limits are two standard deviations beyond.
constexpr double kHalfWidth_mm = 26.0, kMinHalfWidth_mm = 21.5, kMaxHalfWidth_mm = 30.5;
constexpr double kHalfSearch_mm = 34.0;  ///< Columns to each side.
/// Stomion lies 2 to 3 mm above the edge of the upper incisors (\cite vig1978); the mentolabial
/// fold 15 mm or more below, the base of the nose 20 mm above (\cite farkas1994).
constexpr double kSearchUp_mm = 10.0;
constexpr double kSearchLandmark_mm = 3.0;  ///< With the landmark Stm.
constexpr double kStep_mm = 0.5;            ///< Of heights.
constexpr double kShoulder_mm = 4.0;   ///< Depth is measured against the skin this far above and
                                       ///< below: about half the height of a vermilion.
constexpr double kMinCrease_mm = 0.4;  ///< Less is noise of a scan with voxels of 0.5 to 1 mm.
constexpr double kMaxCrease_mm = 4.0;  ///< Lips apart are deeper; that does not count more.
constexpr double kMiddle_mm = 12.0;    ///< Half of the part that decides whether there is a crease.
constexpr double kCommissure = 0.25;   ///< Depth at the commissure, as fraction of the middle.
/// Labiolingual diameter of the crown of an upper central incisor (\cite nelson2015).
constexpr double kIncisor_mm = 7.0;
constexpr double kLip_mm = 12.0;  ///< Thickness of a lip, if no bone is found behind it.

/// Heights searched in each column, and the skin there.
struct Profiles {
  double first_x_mm = 0.0;
  std::size_t columns = 0, heights = 0;
  std::vector<double> center_z_mm;  ///< Of each column.
  double half_height_mm = 0.0;
  std::vector<double> y_mm;      ///< Of the skin; columns x heights with shoulders.
  std::vector<double> depth_mm;  ///< Of the crease; columns x heights.

  [[nodiscard]] double z_mm(std::size_t column, std::size_t height) const {
    return center_z_mm[column] - half_height_mm + kStep_mm * double(height);
  }
};

/// The first point of soft tissue on a line from anterior; `end_y_mm` if there is none.
double skin_y_mm(const image::ScalarVolume& soft_tissue, double x_mm, double z_mm,
                 double begin_y_mm, double end_y_mm) {
  double before = -1.0;
  for (double y_mm = begin_y_mm; y_mm < end_y_mm; y_mm += kStep_mm) {
    const double level = image::interpolate(soft_tissue, {x_mm, y_mm, z_mm}, -1.0);
    if (level > 0.0) return y_mm - kStep_mm * level / (level - std::min(before, 0.0));
    before = level;
  }
  return end_y_mm;
}

void measure(Profiles& profiles, const image::ScalarVolume& soft_tissue, double end_y_mm) {
  const auto shoulder = std::size_t(std::lround(kShoulder_mm / kStep_mm));
  const std::size_t stride = profiles.heights + 2 * shoulder;
  const double begin_y_mm = end_y_mm - 80.0;  // No nose or lip is that far before the teeth.
  profiles.y_mm.resize(profiles.columns * stride);
  for (std::size_t c = 0; c < profiles.columns; ++c)
    for (std::size_t h = 0; h < stride; ++h)
      profiles.y_mm[c * stride + h] =
          skin_y_mm(soft_tissue, profiles.first_x_mm + double(c),
                    profiles.z_mm(c, h) - kShoulder_mm, begin_y_mm, end_y_mm);
  profiles.depth_mm.resize(profiles.columns * profiles.heights);
  for (std::size_t c = 0; c < profiles.columns; ++c)
    for (std::size_t h = 0; h < profiles.heights; ++h) {
      const double* y = &profiles.y_mm[c * stride + h];
      profiles.depth_mm[c * profiles.heights + h] = y[shoulder] - 0.5 * (y[0] + y[2 * shoulder]);
    }
}

/// The path through all columns that maximizes depth minus penalties, by dynamic programming
/// (\cite amini1990). The weights balance 1 mm of depth with 10 mm from the expected height, and
/// with a slope of two.
std::vector<std::size_t> find_path(const Profiles& profiles) {
  constexpr double kPrior = 0.01, kBend = 0.25;  // [1/mm]
  const std::size_t n = profiles.heights, reach = 2;
  std::vector<double> best(n, 0.0);
  std::vector<std::vector<std::size_t>> from(profiles.columns, std::vector<std::size_t>(n, 0));
  for (std::size_t c = 0; c < profiles.columns; ++c) {
    std::vector<double> next(n);
    for (std::size_t h = 0; h < n; ++h) {
      double most = -std::numeric_limits<double>::infinity();
      const std::size_t begin = h > reach ? h - reach : 0, end = std::min(n, h + reach + 1);
      for (std::size_t g = begin; g < end && c > 0; ++g) {
        const double dz_mm = kStep_mm * (double(h) - double(g));
        const double value = best[g] - kBend * dz_mm * dz_mm;
        if (value <= most) continue;
        most = value;
        from[c][h] = g;
      }
      const double off_mm = profiles.z_mm(c, h) - profiles.center_z_mm[c];
      next[h] = (c > 0 ? most : 0.0) - kPrior * off_mm * off_mm +
                std::clamp(profiles.depth_mm[c * n + h], -kMaxCrease_mm, kMaxCrease_mm);
    }
    best = std::move(next);
  }
  std::vector<std::size_t> path(profiles.columns);
  path.back() = std::size_t(std::max_element(best.begin(), best.end()) - best.begin());
  for (std::size_t c = profiles.columns - 1; c > 0; --c) path[c - 1] = from[c][path[c]];
  return path;
}

/// Moving average over `half` columns to each side.
template <class Value>
void smooth(std::vector<OralFissure::Column>& columns, std::size_t half, Value value) {
  const std::vector<OralFissure::Column> raw = columns;
  for (std::size_t c = 0; c < raw.size(); ++c) {
    const std::size_t begin = c > half ? c - half : 0, end = std::min(raw.size(), c + half + 1);
    double sum = 0.0;
    for (std::size_t i = begin; i < end; ++i) sum += raw[i].*value;
    columns[c].*value = sum / double(end - begin);
  }
}

/// Expected height of the fissure at x: through the landmarks, else constant.
double expected_z_mm(const LipLandmarks& landmarks, double edge_z_mm, double x_mm) {
  if (!landmarks.stomion_L) return edge_z_mm;
  const Vec3& stomion_L = *landmarks.stomion_L;
  const auto& corner = x_mm < stomion_L.x() ? landmarks.right_L : landmarks.left_L;
  if (!corner || !(std::abs(corner->x() - stomion_L.x()) > 1.0)) return stomion_L.z();
  const double t = std::clamp((x_mm - stomion_L.x()) / (corner->x() - stomion_L.x()), 0.0, 1.2);
  return stomion_L.z() + t * (corner->z() - stomion_L.z());
}

/// Commissures: where the crease fades, within the limits; landmarks override it.
void find_commissures(OralFissure& fissure, const LipLandmarks& landmarks, double middle_x_mm) {
  const auto crease_at = [&](double x_mm) {
    const auto c = std::size_t(
        std::clamp(std::lround(x_mm - fissure.first_x_mm), 0L, long(fissure.columns.size()) - 1));
    return fissure.columns[c].crease_mm;
  };
  const auto half_width = [&](double sign) {
    if (fissure.source == FissureSource::kJaws) return kHalfWidth_mm;
    const double threshold_mm = kCommissure * fissure.crease_depth_mm;
    if (!(threshold_mm > 0.0)) return kHalfWidth_mm;
    double half_mm = kMinHalfWidth_mm;
    while (half_mm < kMaxHalfWidth_mm && crease_at(middle_x_mm + sign * half_mm) >= threshold_mm)
      half_mm += 1.0;
    return std::min(half_mm, kMaxHalfWidth_mm);
  };
  fissure.right_x_mm = landmarks.right_L ? landmarks.right_L->x() : middle_x_mm - half_width(-1.0);
  fissure.left_x_mm = landmarks.left_L ? landmarks.left_L->x() : middle_x_mm + half_width(1.0);
}

/// Depth of the crease, whether it counts, and its fraction of the width.
void judge_crease(OralFissure& fissure, double middle_x_mm, bool has_landmark) {
  std::vector<double> middle;
  for (std::size_t c = 0; c < fissure.columns.size(); ++c)
    if (std::abs(fissure.first_x_mm + double(c) - middle_x_mm) <= kMiddle_mm)
      middle.push_back(fissure.columns[c].crease_mm);
  fissure.crease_depth_mm = std::max(0.0, median_of(middle));
  fissure.source =
      fissure.crease_depth_mm >= kMinCrease_mm ? FissureSource::kCrease : FissureSource::kJaws;
  if (has_landmark) fissure.source = FissureSource::kLandmarks;
}

double crease_fraction(const OralFissure& fissure) {
  Index all = 0, with = 0;
  for (std::size_t c = 0; c < fissure.columns.size(); ++c) {
    const double x_mm = fissure.first_x_mm + double(c);
    if (x_mm < fissure.right_x_mm || x_mm > fissure.left_x_mm) continue;
    ++all;
    with += fissure.columns[c].crease_mm >= kMinCrease_mm;
  }
  return all == 0 ? 0.0 : double(with) / double(all);
}

/// Columns along the path; without crease and landmark, at the expected height.
void add_columns(OralFissure& fissure, const Profiles& profiles,
                 const std::vector<std::size_t>& path, const std::vector<double>& jaw_y_mm) {
  const std::size_t stride = profiles.y_mm.size() / profiles.columns;
  const std::size_t shoulder = (stride - profiles.heights) / 2;
  fissure.columns.resize(profiles.columns);
  for (std::size_t c = 0; c < profiles.columns; ++c) {
    OralFissure::Column& column = fissure.columns[c];
    column.skin_y_mm = profiles.y_mm[c * stride + path[c] + shoulder];
    column.skin_z_mm = profiles.z_mm(c, path[c]);
    column.crease_mm = profiles.depth_mm[c * profiles.heights + path[c]];
    constexpr double kMinDepth_mm = 3.0;  // The surface must not be steep.
    column.jaw_y_mm = std::max(jaw_y_mm.empty() ? column.skin_y_mm + kLip_mm : jaw_y_mm[c],
                               column.skin_y_mm + kMinDepth_mm);
  }
  smooth(fissure.columns, 2, &OralFissure::Column::skin_y_mm);
  smooth(fissure.columns, 2, &OralFissure::Column::skin_z_mm);
  smooth(fissure.columns, 2, &OralFissure::Column::crease_mm);
  smooth(fissure.columns, 2, &OralFissure::Column::jaw_y_mm);
}

}  // namespace

double OralFissure::level(const Vec3& p_L) const {
  const double at = std::clamp(p_L.x() - first_x_mm, 0.0, double(columns.size()) - 1.001);
  const auto c = std::size_t(at);
  const double t = at - double(c);
  const auto lerp = [&](double Column::*value) {
    return (1.0 - t) * columns[c].*value + t * columns[c + 1].*value;
  };
  const double skin_y = lerp(&Column::skin_y_mm), jaw_y = lerp(&Column::jaw_y_mm);
  const double skin_z = lerp(&Column::skin_z_mm);
  const double along = std::clamp((p_L.y() - skin_y) / (jaw_y - skin_y), 0.0, 1.0);
  const double slope_x = columns[c + 1].skin_z_mm - columns[c].skin_z_mm;
  const double slope_y = (edge_z_mm - skin_z) / (jaw_y - skin_y);
  const double height_mm = skin_z + along * (edge_z_mm - skin_z);
  return (p_L.z() - height_mm) / std::sqrt(1.0 + slope_x * slope_x + slope_y * slope_y);
}

double OralFissure::extent(const Vec3& p_L) const {
  const auto c =
      std::size_t(std::clamp(std::lround(p_L.x() - first_x_mm), 0L, long(columns.size()) - 1));
  return std::min(
      {p_L.x() - right_x_mm, left_x_mm - p_L.x(), columns[c].jaw_y_mm + kIncisor_mm - p_L.y()});
}

FissureSearch find_oral_fissure(const anatomy::LabelMap& labels,
                                const image::ScalarVolume& soft_tissue,
                                const LipLandmarks& landmarks, const JawTeeth* teeth) {
  const std::optional<JawEdges> edges = find_jaw_edges(labels, teeth);
  const auto& stomion = landmarks.stomion_L;
  if (!edges && !stomion)
    return {std::nullopt,
            "no mandible is segmented below the upper jaw, and the plan has no "
            "landmark Stm"};
  OralFissure fissure;
  fissure.edge_z_mm = edges ? edges->middle_z_mm() : stomion->z();
  const double middle_x_mm = stomion ? stomion->x() : edges->middle_x_mm;
  Profiles profiles;
  profiles.half_height_mm = stomion ? kSearchLandmark_mm : kSearchUp_mm;
  profiles.first_x_mm = fissure.first_x_mm = middle_x_mm - kHalfSearch_mm;
  profiles.columns = std::size_t(2.0 * kHalfSearch_mm) + 1;
  profiles.heights = std::size_t(2.0 * profiles.half_height_mm / kStep_mm) + 1;
  for (std::size_t c = 0; c < profiles.columns; ++c)
    profiles.center_z_mm.push_back(
        expected_z_mm(landmarks, fissure.edge_z_mm, fissure.first_x_mm + double(c)));
  std::array<double, 2> edges_z_mm{fissure.edge_z_mm, fissure.edge_z_mm};
  if (edges)
    edges_z_mm = {std::min(edges->upper_z_mm, edges->lower_z_mm),
                  std::max(edges->upper_z_mm, edges->lower_z_mm)};
  const std::vector<double> jaw_y_mm =
      anterior_surface_y_mm(labels, fissure.first_x_mm, profiles.columns, edges_z_mm, teeth);
  if (jaw_y_mm.empty() && !stomion) return {std::nullopt, "no bone lies behind the mouth"};
  const double end_y_mm = jaw_y_mm.empty()
                              ? stomion->y() + kLip_mm
                              : *std::max_element(jaw_y_mm.begin(), jaw_y_mm.end()) + kIncisor_mm;
  measure(profiles, soft_tissue, end_y_mm);
  std::vector<std::size_t> path = find_path(profiles);
  add_columns(fissure, profiles, path, jaw_y_mm);
  judge_crease(fissure, middle_x_mm, stomion.has_value());
  if (fissure.source == FissureSource::kJaws) {
    std::fill(path.begin(), path.end(), profiles.heights / 2);
    add_columns(fissure, profiles, path, jaw_y_mm);
  }
  find_commissures(fissure, landmarks, middle_x_mm);
  if (!(fissure.width_mm() > 10.0))
    return {std::nullopt, "the landmarks Ch-R and Ch-L do not lie on either side of the mouth"};
  const bool is_given = stomion && landmarks.right_L && landmarks.left_L;
  fissure.confidence = is_given ? 1.0 : crease_fraction(fissure);
  if (fissure.source == FissureSource::kJaws) fissure.confidence = 0.0;
  return {std::move(fissure), ""};
}

}  // namespace lefort::predict
