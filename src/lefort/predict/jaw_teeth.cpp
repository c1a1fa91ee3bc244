#include <lefort/core/decompositions.h>
#include <lefort/image/visit_voxels_near.h>
#include <lefort/predict/jaw_edges.h>
#include <lefort/predict/jaw_teeth.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>

namespace lefort::predict {
namespace {

constexpr double kMinToothPart_mm3 = 30.0;  ///< Less is no crown.
constexpr double kUprightTooth = 0.6;       ///< Cosine of the axis and z: as dental::number_teeth.
constexpr double kMinSize = 0.7, kMaxSize = 1.1;  ///< Of a tooth, relative to the mean.
constexpr double kTipFraction = 0.02;             ///< Of the voxels, at the edge or the cusps.
constexpr double kBeyondCrown_mm = 1.5;  ///< Half of the space between two teeth that belong to
                                         ///< one arch; a gap of a tooth is 5 mm and wider.
constexpr double kAcrossArch_mm = 15.0;  ///< An alveolar process is 10 to 20 mm thick.
constexpr double kNearCrown_mm = 2.0;    ///< Two voxels of a clinical scan.

bool is_permanent(int fdi) { return fdi >= 11 && fdi <= 48 && fdi % 10 >= 1 && fdi % 10 <= 8; }

/// Place in the arch, from the right third molar to the left one.
int place_in_arch(int fdi) {
  const bool is_right = fdi / 10 == 1 || fdi / 10 == 4;
  return is_right ? -(fdi % 10) : fdi % 10;
}

Vec3 axis_of(const std::vector<Vec3>& all_L, const Vec3& mean_L, bool is_lower) {
  Mat3 spread = Mat3::Zero();
  for (const Vec3& p_L : all_L) spread += (p_L - mean_L) * (p_L - mean_L).transpose();
  Vec3 occlusal_L = is_lower ? Vec3(Vec3::UnitZ()) : Vec3(-Vec3::UnitZ());
  const Vec3 axis_L = symmetric_eigen(spread).vectors.col(2);
  if (std::abs(axis_L.dot(occlusal_L)) < kUprightTooth) return occlusal_L;
  return axis_L.dot(occlusal_L) < 0.0 ? Vec3(-axis_L) : axis_L;
}

/// A tooth without its direction and width along the arch.
JawTooth tooth_of(int fdi, std::vector<Vec3> all_L) {
  JawTooth tooth;
  tooth.fdi = fdi;
  Vec3 mean_L = Vec3::Zero();
  for (const Vec3& p_L : all_L) mean_L += p_L / double(all_L.size());
  tooth.axis_L = axis_of(all_L, mean_L, tooth.is_lower());
  const std::size_t tips =
      std::max<std::size_t>(1, std::size_t(std::lround(kTipFraction * double(all_L.size()))));
  const auto middle = all_L.begin() + std::ptrdiff_t(tips) - 1;
  std::nth_element(all_L.begin(), middle, all_L.end(), [&](const Vec3& a, const Vec3& b) {
    return tooth.axis_L.dot(a) > tooth.axis_L.dot(b);
  });
  const double tip_mm = tooth.axis_L.dot(*middle - mean_L);
  tooth.tip_L = mean_L + tip_mm * tooth.axis_L;
  double apex_mm = tip_mm;
  for (const Vec3& p_L : all_L) apex_mm = std::min(apex_mm, tooth.axis_L.dot(p_L - mean_L));
  const double size = std::clamp((tip_mm - apex_mm) / tooth_length_mm(fdi), kMinSize, kMaxSize);
  tooth.border_L = tooth.tip_L - size * crown_height_mm(fdi) * tooth.axis_L;
  const double sign = tooth.is_lower() ? 1.0 : -1.0;
  std::nth_element(all_L.begin(), middle, all_L.end(),
                   [&](const Vec3& a, const Vec3& b) { return sign * a.z() > sign * b.z(); });
  tooth.edge_z_mm = middle->z();
  return tooth;
}

/// Direction of the arch at a tooth that has no neighbor.
Vec3 expected_direction(int fdi) {
  const int number = fdi % 10;
  if (number <= 2) return Vec3::UnitX();
  if (number >= 4) return Vec3::UnitY();
  return Vec3(1.0, place_in_arch(fdi) > 0 ? 1.0 : -1.0, 0.0).normalized();
}

/// Direction of the arch at each tooth: from the tooth before it to the one behind it.
void find_directions(std::vector<JawTooth>& teeth) {
  for (const bool is_lower : {false, true}) {
    std::vector<JawTooth*> arch;
    for (JawTooth& tooth : teeth)
      if (tooth.is_lower() == is_lower) arch.push_back(&tooth);
    std::sort(arch.begin(), arch.end(), [](const JawTooth* a, const JawTooth* b) {
      return place_in_arch(a->fdi) < place_in_arch(b->fdi);
    });
    for (std::size_t n = 0; n < arch.size(); ++n) {
      JawTooth& tooth = *arch[n];
      Vec3 along_L = expected_direction(tooth.fdi);
      if (arch.size() > 1)
        along_L =
            arch[std::min(n + 1, arch.size() - 1)]->border_L - arch[n == 0 ? 0 : n - 1]->border_L;
      along_L -= along_L.dot(tooth.axis_L) * tooth.axis_L;
      if (along_L.norm() > 0.0) tooth.along_L = along_L.normalized();
    }
  }
}

/// Width of the crown: 5 to 95 % of its voxels.
void find_width(JawTooth& tooth, const std::vector<Vec3>& all_L) {
  std::vector<double> at_mm;
  for (const Vec3& p_L : all_L)
    if (tooth.height_mm(p_L) > 0.0) at_mm.push_back(tooth.along_L.dot(p_L - tooth.border_L));
  std::sort(at_mm.begin(), at_mm.end());
  const std::size_t outside = at_mm.size() / 20;
  if (at_mm.empty()) return;
  tooth.half_width_mm = 0.5 * (at_mm[at_mm.size() - 1 - outside] - at_mm[outside]);
}

}  // namespace

double crown_height_mm(int fdi) {
  constexpr std::array<double, 8> kUpper{10.5, 9.0, 10.0, 8.5, 8.5, 7.5, 7.0, 6.5};
  constexpr std::array<double, 8> kLower{9.0, 9.5, 11.0, 8.5, 8.0, 7.5, 7.0, 7.0};
  return (fdi >= 30 ? kLower : kUpper)[std::size_t(fdi % 10 - 1)];
}

double tooth_length_mm(int fdi) {
  constexpr std::array<double, 8> kUpperRoot{13.0, 13.0, 17.0, 14.0, 14.0, 13.0, 12.0, 11.0};
  constexpr std::array<double, 8> kLowerRoot{12.5, 14.0, 16.0, 14.0, 14.5, 14.0, 13.0, 11.0};
  return crown_height_mm(fdi) + (fdi >= 30 ? kLowerRoot : kUpperRoot)[std::size_t(fdi % 10 - 1)];
}

const JawTooth* JawTeeth::tooth_at(const Vec3& p_L, bool on_mandible) const {
  const JawTooth* closest = nullptr;
  double closest_mm = kBeyondCrown_mm;
  for (const JawTooth& tooth : teeth) {
    if (tooth.is_lower() != on_mandible) continue;
    const Vec3 d = p_L - tooth.border_L;
    if (std::abs(tooth.axis_L.cross(tooth.along_L).dot(d)) > kAcrossArch_mm) continue;
    const double beyond_mm = std::abs(tooth.along_L.dot(d)) - tooth.half_width_mm;
    if (beyond_mm > closest_mm) continue;
    closest_mm = beyond_mm;
    closest = &tooth;
  }
  return closest;
}

bool JawTeeth::is_on_crown(const Vec3& p_L) const {
  bool is_on = false;
  const Vec3 p_V = numbers.grid.index_V(p_L);
  image::visit_voxels_near(numbers.grid, p_L, kNearCrown_mm, [&](Index i, Index j, Index k) {
    const int fdi = numbers.at(i, j, k);
    if (is_on || fdi == 0) return;
    const auto tooth =
        std::find_if(teeth.begin(), teeth.end(), [&](const auto& one) { return one.fdi == fdi; });
    if (tooth == teeth.end() || !(tooth->height_mm(p_L) > 0.0)) return;
    const Vec3 beyond_V =
        ((p_V - Vec3(double(i), double(j), double(k))).cwiseAbs().array() - 0.5).cwiseMax(0.0);
    is_on = beyond_V.cwiseProduct(numbers.grid.spacing_mm).norm() <= kNearCrown_mm;
  });
  return is_on;
}

std::optional<double> JawTeeth::edge_z_mm(bool of_mandible) const {
  std::vector<double> incisors, anterior;
  for (const JawTooth& tooth : teeth) {
    if (tooth.is_lower() != of_mandible || !tooth.is_anterior()) continue;
    anterior.push_back(tooth.edge_z_mm);
    if (tooth.is_incisor()) incisors.push_back(tooth.edge_z_mm);
  }
  if (incisors.size() >= 2) return median_of(std::move(incisors));
  if (anterior.size() >= 2) return median_of(std::move(anterior));
  return std::nullopt;
}

JawTeeth find_jaw_teeth(image::Volume<std::uint8_t> numbers) {
  std::map<int, std::vector<Vec3>> voxels_L;
  const auto& size = numbers.grid.size;
  for (Index k = 0; k < size[2]; ++k)
    for (Index j = 0; j < size[1]; ++j)
      for (Index i = 0; i < size[0]; ++i)
        if (const int fdi = numbers.at(i, j, k); is_permanent(fdi))
          voxels_L[fdi].push_back(numbers.grid.point_L({double(i), double(j), double(k)}));
  JawTeeth found;
  const double voxel_mm3 = numbers.grid.spacing_mm.prod();
  for (const auto& [fdi, all_L] : voxels_L)
    if (double(all_L.size()) * voxel_mm3 >= kMinToothPart_mm3)
      found.teeth.push_back(tooth_of(fdi, all_L));
  find_directions(found.teeth);
  for (JawTooth& tooth : found.teeth) find_width(tooth, voxels_L[tooth.fdi]);
  found.numbers = std::move(numbers);
  return found;
}

}  // namespace lefort::predict
