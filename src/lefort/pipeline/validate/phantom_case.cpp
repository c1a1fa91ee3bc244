#include <lefort/anatomy/synthetic_head.h>
#include <lefort/pipeline/validate/phantom_case.h>

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <random>
#include <utility>

namespace lefort::pipeline {
namespace {

using Json = nlohmann::ordered_json;

/// Uniform numbers. Not std::uniform_real_distribution, whose numbers depend on the library.
class UniformNumbers {
 public:
  explicit UniformNumbers(std::uint64_t seed) : bits_(seed) {}
  [[nodiscard]] double draw(double low, double high) {
    constexpr double kUnit = 0x1p-53;
    return low + (high - low) * double(bits_() >> 11) * kUnit;
  }

 private:
  std::mt19937_64 bits_;
};

Json stretched(const Vec3& p, const Vec3& scale) {
  const Vec3 q = p.cwiseProduct(scale);
  return Json::array({q.x(), q.y(), q.z()});
}

Json path_of(const Vec3& translation_mm, double rotation_x_deg, const Json& about_mm) {
  const Vec3& t = translation_mm;
  return {{"steps", 4},
          {"keyframes", Json::array({{{"translation_mm", {t.x(), t.y(), t.z()}},
                                      {"rotation_deg", {rotation_x_deg, 0.0, 0.0}},
                                      {"about_mm", about_mm}}})}};
}

/// The mandible turns about the axis through its condyles.
Json mandible_segment(UniformNumbers& numbers, bool is_setback, const Vec3& scale) {
  const Vec3 condyles(0.0, -18.0, -47.0);  // Of the synthetic head.
  const double y_mm = numbers.draw(3.0, 6.0) * (is_setback ? 1.0 : -1.0);
  const Vec3 translation_mm(numbers.draw(-0.5, 0.5), y_mm, numbers.draw(-1.0, 1.0));
  return {{"name", "mandible"},
          {"osteotomy", {{"bone", "mandible"}}},
          {"path", path_of(translation_mm, numbers.draw(-2.0, 2.0), stretched(condyles, scale))}};
}

/// The block of the maxilla below its middle, anterior to the rami.
Json midface_segment(UniformNumbers& numbers, const Vec3& scale) {
  const Vec3 above(0.0, -50.0, -34.0), behind(0.0, -32.0, -50.0), anchor(15.0, -72.0, -50.0);
  const Vec3 translation_mm(numbers.draw(-0.5, 0.5), -numbers.draw(3.0, 5.0),
                            numbers.draw(-1.0, 1.0));
  return {
      {"name", "maxilla"},
      {"osteotomy",
       {{"planes",
         Json::array({{{"point_mm", stretched(above, scale)}, {"towards_segment", {0, 0, -1}}},
                      {{"point_mm", stretched(behind, scale)}, {"towards_segment", {0, -1, 0}}}})},
        {"anchor_points", Json::array({stretched(anchor, scale)})}}},
      {"path", path_of(translation_mm, 0.0, stretched(above, scale))}};
}

/// A number with the standard normal distribution, from 2 pseudorandom words of the key.
double normal_number(std::uint64_t key) {
  UniformNumbers numbers(key);
  // Box and Muller 1958; the first number is not zero.
  const double radius = std::sqrt(-2.0 * std::log(1.0 - numbers.draw(0.0, 1.0)));
  return radius * std::cos(2.0 * std::numbers::pi * numbers.draw(0.0, 1.0));
}

/// Of a point of the lattice.
double lattice_number(const Eigen::Vector3i& at, std::uint64_t seed) {
  constexpr std::array<std::uint64_t, 3> kStride{0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F,
                                                 0x165667B19E3779F9};  // Odd: no two keys agree.
  std::uint64_t key = seed;
  for (Index axis = 0; axis < 3; ++axis)
    key = (key ^ std::uint64_t(std::int64_t(at[axis]))) * kStride[std::size_t(axis)] + 1;
  return normal_number(key);
}

}  // namespace

double random_field(const Vec3& point_mm, std::uint64_t seed) {
  const Vec3 cells = point_mm / kSkinNoiseLength_mm;
  const Vec3 low = cells.array().floor().matrix();
  const Vec3 part = cells - low;
  double sum = 0.0, variance = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3i offset(corner & 1, (corner >> 1) & 1, corner >> 2);
    double weight = 1.0;
    for (Index axis = 0; axis < 3; ++axis)
      weight *= offset[axis] == 1 ? part[axis] : 1.0 - part[axis];
    sum += weight * lattice_number(low.cast<int>() + offset, seed);
    variance += weight * weight;
  }
  return sum / std::sqrt(variance);
}

PhantomTruth draw_truth(std::uint64_t seed) {
  UniformNumbers numbers(seed);
  const double logarithm = numbers.draw(std::log(2.0), std::log(12.0));
  return {std::exp(logarithm), numbers.draw(0.36, 0.48)};
}

PhantomCase draw_case(const PhantomCohortJob& job, int number, int attempt) {
  constexpr std::uint64_t kStride = 1000003;  // Seeds of cohorts do not overlap.
  constexpr std::uint64_t kCases = 100;       // More than a cohort may have.
  PhantomCase one{
      .name = fmt::format("case_{:02}", number + 1),
      .seed = job.seed * kStride + std::uint64_t(number) + 1 + std::uint64_t(attempt) * kCases,
      .procedure = {},
      .scale = Vec3::Ones(),
      .plan = {}};
  UniformNumbers numbers(one.seed);
  for (Index axis = 0; axis < 3; ++axis) one.scale[axis] = numbers.draw(0.95, 1.05);
  Json segments = Json::array();
  const int kind = number % 4;
  if (kind == 0 || kind == 3) segments.push_back(mandible_segment(numbers, true, one.scale));
  if (kind == 1) segments.push_back(mandible_segment(numbers, false, one.scale));
  if (kind >= 2) segments.push_back(midface_segment(numbers, one.scale));
  one.procedure = kind == 0   ? "mandible setback"
                  : kind == 1 ? "mandible advancement"
                  : kind == 2 ? "mid-face advancement"
                              : "mandible setback and mid-face advancement";
  one.plan = {{"lefort_plan", 1},
              {"title", one.procedure},
              {"segmentation", {{"labels", kPhantomLabels}}},
              {"segments", segments},
              {"tissue",
               {{"element_size_mm", job.element_size_mm},
                {"far_element_size_mm", 2.0 * job.element_size_mm},
                {"margin_mm", 20.0},
                {"skin", {{"thickness_mm", 2.0}, {"layers", 1}}}}},
              {"boundary", {{"interface", "bonded"}}},
              {"field", {{"resolution", 128}, {"band_mm", 6}}}};
  return one;
}

anatomy::LabeledScan phantom_scan(const PhantomCohortJob& job, const PhantomCase& one) {
  anatomy::SyntheticMaterials materials;
  materials.noise_hu = job.noise_hu;
  const image::Grid grid = anatomy::synthetic_grid(job.voxel_mm);
  anatomy::LabeledScan scan{anatomy::synthetic_scan(grid, materials, one.seed),
                            anatomy::synthetic_labels(grid)};
  for (image::Grid* stretched_grid : {&scan.ct.grid, &scan.labels.grid}) {
    stretched_grid->spacing_mm = stretched_grid->spacing_mm.cwiseProduct(one.scale);
    stretched_grid->origin_L = stretched_grid->origin_L.cwiseProduct(one.scale);
  }
  return scan;
}

plan::Landmarks phantom_landmarks(const PhantomCase& one) {
  // Of the synthetic head: middle of its nose, height of Sn, and from there to soft menton.
  constexpr double kMiddle_mm = 3.0, kSubnasale_mm = -43.0, kLowerFace_mm = 59.0;
  constexpr double kFront_mm = -140.0, kStep_mm = 0.1;
  plan::Landmarks landmarks;
  const auto add = [&](const std::string& name, double lateral, double above) {
    Vec3 p(kMiddle_mm + lateral * kLowerFace_mm, kFront_mm, kSubnasale_mm + above * kLowerFace_mm);
    while (p.y() < 0.0 && anatomy::synthetic::skin(p) <= 0.0) p.y() += kStep_mm;
    landmarks.push_back({name, p.cwiseProduct(one.scale)});
  };
  for (const auto& [name, above] :
       std::initializer_list<std::pair<const char*, double>>{{"Prn", 0.16},
                                                             {"N'", 0.75},
                                                             {"Sn", 0.0},
                                                             {"Stm", -1.0 / 3.0},
                                                             {"Li", -0.45},
                                                             {"Pg'", -0.75},
                                                             {"Me'", -1.0}})
    add(name, 0.0, above);
  for (const double side : {-1.0, 1.0}) {
    const std::string suffix = side < 0.0 ? "-R" : "-L";
    add("Al" + suffix, 0.25 * side, 0.05);
    add("En" + suffix, 0.24 * side, 0.65);
    add("Ex" + suffix, 0.66 * side, 0.65);
    add("Ch" + suffix, 0.37 * side, -1.0 / 3.0);
  }
  return landmarks;
}

}  // namespace lefort::pipeline
