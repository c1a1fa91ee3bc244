#include <lefort/predict/jaw_edges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace lefort::predict {
namespace {

using anatomy::Tissue;

constexpr double kMinMandible_mm3 = 5000.0;  ///< An adult's has 55 to 110 ml; less is no jaw.
constexpr double kAnterior_mm = 15.0;        ///< Depth of the symphysis, about.
constexpr double kHalfMiddle_mm = 10.0;      ///< The four incisors: half their width, about 11 mm.
constexpr double kBehind_mm = 25.0;          ///< Incisors lie within this distance behind the chin,
constexpr double kBefore_mm = 12.0;          ///< or this far before it.
constexpr double kCrown_mm = 6.0;            ///< Above and below the level, within the crowns.
/// The crowns of one side, incisor to second molar, are 55 mm long (\cite nelson2015); the arch is
/// shallower, because it curves.
constexpr double kArchDepth_mm = 45.0;
constexpr double kHalfArch_mm = 34.0;  ///< Bone further from the middle is ramus.
constexpr double kMaxGap_mm = 20.0;    ///< Between opposite edges; more is no dental arch.
/// The occlusal plane slopes by 1.5 to 14 degrees against Frankfort (\cite downs1948); heads are
/// scanned with some inclination.
constexpr double kMaxSlope = 0.36;

/// Calls visit(point, tissue) for all voxels of bone, in order.
template <class Visit>
void for_each_bone(const anatomy::LabelMap& labels, const Visit& visit) {
  const auto& size = labels.grid.size;
  for (Index k = 0; k < size[2]; ++k)
    for (Index j = 0; j < size[1]; ++j)
      for (Index i = 0; i < size[0]; ++i)
        if (const Tissue tissue = labels.at(i, j, k); anatomy::is_bone(tissue))
          visit(labels.grid.point_L({double(i), double(j), double(k)}), tissue);
}

/// Position of the mandible.
struct Chin {
  double x_mm, y_mm, z_mm;  ///< z: middle of the height at the symphysis.
};

std::optional<Chin> find_chin(const anatomy::LabelMap& labels) {
  std::vector<double> all_y;
  for_each_bone(labels, [&](const Vec3& p_L, Tissue tissue) {
    if (tissue == Tissue::kMandible) all_y.push_back(p_L.y());
  });
  if (double(all_y.size()) * labels.grid.spacing_mm.prod() < kMinMandible_mm3) return std::nullopt;
  // The most anterior voxels may be artifacts: one in 200.
  const auto anterior = all_y.begin() + std::ptrdiff_t(all_y.size() / 200);
  std::nth_element(all_y.begin(), anterior, all_y.end());
  const double y_mm = *anterior;
  std::vector<double> x, z;
  for_each_bone(labels, [&](const Vec3& p_L, Tissue tissue) {
    if (tissue != Tissue::kMandible || p_L.y() > y_mm + kAnterior_mm) return;
    x.push_back(p_L.x());
    z.push_back(p_L.z());
  });
  return Chin{median_of(x), y_mm, median_of(z)};
}

/// Lowest upper and highest lower bone of each cell of 1 mm by 1 mm.
struct OppositeEdges {
  double y_mm = 0.0;
  double upper_z_mm = std::numeric_limits<double>::infinity();
  double lower_z_mm = -std::numeric_limits<double>::infinity();
};

std::vector<OppositeEdges> opposite_edges(const anatomy::LabelMap& labels, const JawEdges& edges,
                                          double front_y_mm) {
  std::map<std::pair<Index, Index>, OppositeEdges> cells;
  for_each_bone(labels, [&](const Vec3& p_L, Tissue tissue) {
    const double x_mm = p_L.x() - edges.middle_x_mm, y_mm = p_L.y() - front_y_mm;
    if (std::abs(x_mm) > kHalfArch_mm || y_mm < 0.0 || y_mm > kArchDepth_mm ||
        std::abs(p_L.z() - edges.middle_z_mm()) > kMaxGap_mm)
      return;
    OppositeEdges& cell = cells[{Index(std::lround(x_mm)), Index(std::lround(y_mm))}];
    cell.y_mm = p_L.y();
    if (tissue == Tissue::kMandible)
      cell.lower_z_mm = std::max(cell.lower_z_mm, p_L.z());
    else
      cell.upper_z_mm = std::min(cell.upper_z_mm, p_L.z());
  });
  std::vector<OppositeEdges> both;
  for (const auto& [at, cell] : cells)
    if (cell.upper_z_mm - cell.lower_z_mm > -kCrown_mm &&
        cell.upper_z_mm - cell.lower_z_mm < kMaxGap_mm)
      both.push_back(cell);
  return both;
}

constexpr std::size_t kMinCells = 30;  ///< With fewer, the plane is horizontal.

/// Slope of the middle between opposite edges, from the medians of its anterior and posterior
/// thirds: single cells may be artifacts of metal.
double occlusal_slope(std::vector<OppositeEdges> cells) {
  if (cells.size() < kMinCells) return 0.0;
  std::stable_sort(cells.begin(), cells.end(),
                   [](const OppositeEdges& a, const OppositeEdges& b) { return a.y_mm < b.y_mm; });
  const std::size_t third = cells.size() / 3;
  const auto median_in = [&](std::size_t begin) {
    std::vector<double> y, z;
    for (std::size_t c = begin; c < begin + third; ++c) {
      y.push_back(cells[c].y_mm);
      z.push_back(0.5 * (cells[c].upper_z_mm + cells[c].lower_z_mm));
    }
    return std::pair{median_of(y), median_of(z)};
  };
  const auto [front_y, front_z] = median_in(0);
  const auto [back_y, back_z] = median_in(cells.size() - third);
  constexpr double kMinLength_mm = 10.0;
  if (back_y - front_y < kMinLength_mm) return 0.0;
  return std::clamp((back_z - front_z) / (back_y - front_y), -kMaxSlope, kMaxSlope);
}

}  // namespace

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::optional<JawEdges> find_jaw_edges(const anatomy::LabelMap& labels) {
  const std::optional<Chin> chin = find_chin(labels);
  if (!chin) return std::nullopt;
  std::map<Index, double> upper, lower;  // By column of 1 mm.
  for_each_bone(labels, [&](const Vec3& p_L, Tissue tissue) {
    if (std::abs(p_L.x() - chin->x_mm) > kHalfMiddle_mm || p_L.y() > chin->y_mm + kBehind_mm ||
        p_L.y() < chin->y_mm - kBefore_mm || p_L.z() < chin->z_mm)
      return;
    const auto column = Index(std::lround(p_L.x() - chin->x_mm));
    if (tissue == Tissue::kMandible) {
      auto& z = lower.try_emplace(column, p_L.z()).first->second;
      z = std::max(z, p_L.z());
    } else {
      auto& z = upper.try_emplace(column, p_L.z()).first->second;
      z = std::min(z, p_L.z());
    }
  });
  if (upper.empty() || lower.empty()) return std::nullopt;
  const auto middle_of = [](const std::map<Index, double>& edges) {
    std::vector<double> z;
    for (const auto& [column, z_mm] : edges) z.push_back(z_mm);
    return median_of(z);
  };
  return JawEdges{chin->x_mm, middle_of(upper), middle_of(lower)};
}

std::vector<double> anterior_surface_y_mm(const anatomy::LabelMap& labels, double first_x_mm,
                                          std::size_t count,
                                          const std::array<double, 2>& edges_z_mm) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  std::vector<double> y(count, kNone);
  for_each_bone(labels, [&](const Vec3& p_L, Tissue) {
    const auto column = std::lround(p_L.x() - first_x_mm);
    if (p_L.z() < edges_z_mm[0] - kCrown_mm || p_L.z() > edges_z_mm[1] + kCrown_mm || column < 0 ||
        std::size_t(column) >= count)
      return;
    y[std::size_t(column)] = std::min(y[std::size_t(column)], p_L.y());
  });
  std::vector<std::size_t> known;
  for (std::size_t c = 0; c < count; ++c)
    if (y[c] < kNone) known.push_back(c);
  if (known.empty()) return {};
  std::vector<double> filled(count), smooth(count);
  for (std::size_t c = 0; c < count; ++c) {
    const auto distance = [c](std::size_t other) { return other > c ? other - c : c - other; };
    filled[c] = y[*std::min_element(known.begin(), known.end(), [&](std::size_t a, std::size_t b) {
      return distance(a) < distance(b);
    })];
  }
  constexpr std::size_t kWindow = 4;  // Median over 9 mm: a tooth is 5 to 9 mm wide.
  for (std::size_t c = 0; c < count; ++c) {
    const std::size_t begin = c > kWindow ? c - kWindow : 0, end = std::min(count, c + kWindow + 1);
    smooth[c] =
        median_of({filled.begin() + std::ptrdiff_t(begin), filled.begin() + std::ptrdiff_t(end)});
  }
  return smooth;
}

std::optional<DentalArches> find_dental_arches(const anatomy::LabelMap& labels,
                                               const JawEdges& edges) {
  const std::array<double, 2> edges_z_mm{std::min(edges.upper_z_mm, edges.lower_z_mm),
                                         std::max(edges.upper_z_mm, edges.lower_z_mm)};
  const std::vector<double> front_y_mm =
      anterior_surface_y_mm(labels, edges.middle_x_mm - kHalfMiddle_mm,
                            std::size_t(2.0 * kHalfMiddle_mm) + 1, edges_z_mm);
  if (front_y_mm.empty()) return std::nullopt;
  DentalArches arches;
  arches.first_y_mm = median_of(front_y_mm);
  const std::vector<OppositeEdges> cells = opposite_edges(labels, edges, arches.first_y_mm);
  arches.slope = occlusal_slope(cells);
  arches.first_z_mm = edges.middle_z_mm();
  if (cells.size() >= kMinCells) {
    std::vector<double> z;
    for (const OppositeEdges& cell : cells)
      z.push_back(0.5 * (cell.upper_z_mm + cell.lower_z_mm) -
                  arches.slope * (cell.y_mm - arches.first_y_mm));
    arches.first_z_mm = median_of(std::move(z));
  }
  const double half_gap_mm = 0.5 * (edges_z_mm[1] - edges_z_mm[0]) + kCrown_mm;
  const auto count = std::size_t(kArchDepth_mm);
  constexpr double kNone = std::numeric_limits<double>::infinity();
  arches.rows.assign(count, {kNone, -kNone});
  for_each_bone(labels, [&](const Vec3& p_L, Tissue) {
    const double y_mm = p_L.y() - arches.first_y_mm;
    const auto row = std::lround(y_mm);
    const double level_mm = arches.first_z_mm + arches.slope * y_mm;
    if (row < 0 || std::size_t(row) >= count || std::abs(p_L.z() - level_mm) > half_gap_mm ||
        std::abs(p_L.x() - edges.middle_x_mm) > kHalfArch_mm)
      return;
    DentalArches::Row& outline = arches.rows[std::size_t(row)];
    outline.right_x_mm = std::min(outline.right_x_mm, p_L.x());
    outline.left_x_mm = std::max(outline.left_x_mm, p_L.x());
  });
  // A row without bone is as wide as the one before it; the first is that of the incisors.
  DentalArches::Row last{edges.middle_x_mm - kHalfMiddle_mm, edges.middle_x_mm + kHalfMiddle_mm};
  for (DentalArches::Row& row : arches.rows) {
    if (row.right_x_mm > row.left_x_mm) row = last;
    last = row;
  }
  return arches;
}

}  // namespace lefort::predict
