#include <lefort/predict/jaw_edges.h>
#include <lefort/predict/jaw_teeth.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace lefort::predict {
namespace {

using anatomy::Tissue;

constexpr double kMinMandible_mm3 = 5000.0;  ///< An adult's has 55 to 110 ml; less is no jaw.
constexpr double kAnterior_mm = 15.0;        ///< Depth of the symphysis, about.
constexpr double kHalfMiddle_mm = 10.0;      ///< The four incisors: half their width, about 11 mm.
constexpr double kBehind_mm = 25.0;          ///< Incisors lie within this distance behind the chin,
constexpr double kBefore_mm = 12.0;          ///< or this far before it.
constexpr double kCrown_mm = 6.0;            ///< Above and below the level, within the crowns.

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

/// Calls visit(point) for all voxels of teeth.
template <class Visit>
void for_each_tooth_voxel(const JawTeeth& teeth, const Visit& visit) {
  const auto& grid = teeth.numbers.grid;
  for (Index k = 0; k < grid.size[2]; ++k)
    for (Index j = 0; j < grid.size[1]; ++j)
      for (Index i = 0; i < grid.size[0]; ++i)
        if (teeth.numbers.at(i, j, k) != 0) visit(grid.point_L({double(i), double(j), double(k)}));
}

constexpr double kNoSurface_mm = std::numeric_limits<double>::infinity();

/// Columns without a surface get that of the closest one with a surface; then the median of 9.
std::vector<double> smooth_columns(const std::vector<double>& y) {
  const std::size_t count = y.size();
  std::vector<std::size_t> known;
  for (std::size_t c = 0; c < count; ++c)
    if (y[c] < kNoSurface_mm) known.push_back(c);
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

}  // namespace

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::optional<JawEdges> find_jaw_edges(const anatomy::LabelMap& labels, const JawTeeth* teeth) {
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
    z.reserve(edges.size());
    for (const auto& [column, z_mm] : edges) z.push_back(z_mm);
    return median_of(z);
  };
  JawEdges edges{chin->x_mm, middle_of(upper), middle_of(lower)};
  if (teeth == nullptr) return edges;
  edges.upper_z_mm = teeth->edge_z_mm(false).value_or(edges.upper_z_mm);
  edges.lower_z_mm = teeth->edge_z_mm(true).value_or(edges.lower_z_mm);
  return edges;
}

std::vector<double> anterior_surface_y_mm(const anatomy::LabelMap& labels, double first_x_mm,
                                          std::size_t count,
                                          const std::array<double, 2>& edges_z_mm,
                                          const JawTeeth* teeth) {
  std::vector<double> y(count, kNoSurface_mm), of_teeth(count, kNoSurface_mm);
  const auto add = [&](const Vec3& p_L, std::vector<double>& surface) {
    const auto column = std::lround(p_L.x() - first_x_mm);
    if (p_L.z() < edges_z_mm[0] - kCrown_mm || p_L.z() > edges_z_mm[1] + kCrown_mm || column < 0 ||
        std::size_t(column) >= count)
      return;
    surface[std::size_t(column)] = std::min(surface[std::size_t(column)], p_L.y());
  };
  for_each_bone(labels, [&](const Vec3& p_L, Tissue) { add(p_L, y); });
  if (teeth != nullptr) for_each_tooth_voxel(*teeth, [&](const Vec3& p_L) { add(p_L, of_teeth); });
  for (std::size_t c = 0; c < count; ++c)
    if (of_teeth[c] < kNoSurface_mm) y[c] = of_teeth[c];
  return smooth_columns(y);
}

}  // namespace lefort::predict
