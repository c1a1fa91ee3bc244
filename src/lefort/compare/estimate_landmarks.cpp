#include <lefort/compare/estimate_landmarks.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace lefort::compare {
namespace {

using geometry::TriangleMesh;

/// \returns the most anterior vertex; the first of equals.
Vec3 find_pronasale(const TriangleMesh& skin_L) {
  Vec3 found = skin_L.vertices.front();
  for (const Vec3& v : skin_L.vertices)
    if (v.y() < found.y()) found = v;
  return found;
}

/// \returns the height of the lowest bone near the mid-plane of the face; `prn_L.z()` if there is
///   none.
double menton_height_mm(const TriangleMesh& bone_L, const Vec3& prn_L) {
  constexpr double kBehind_mm = 60.0, kBeside_mm = 35.0;
  double lowest_mm = prn_L.z();
  for (const Vec3& v : bone_L.vertices)
    if (v.y() < prn_L.y() + kBehind_mm && std::abs(v.x() - prn_L.x()) < kBeside_mm)
      lowest_mm = std::min(lowest_mm, v.z());
  return lowest_mm;
}

/// \returns the point of the skin at (x, z) as seen from the front.
Vec3 on_skin(const TriangleMesh& skin_L, double x_mm, double z_mm, double fallback_y_mm) {
  constexpr double kRadius_mm = 6.0;
  double y_mm = std::numeric_limits<double>::infinity();
  for (const Vec3& v : skin_L.vertices)
    if (std::hypot(v.x() - x_mm, v.z() - z_mm) < kRadius_mm) y_mm = std::min(y_mm, v.y());
  return {x_mm, std::isfinite(y_mm) ? y_mm : fallback_y_mm, z_mm};
}

}  // namespace

Result<plan::Landmarks> estimate_landmarks(const TriangleMesh& skin_L, const TriangleMesh& bone_L) {
  constexpr double kMinHeight_mm = 30.0;
  const Vec3 prn_L = find_pronasale(skin_L);
  const double height_mm = prn_L.z() - menton_height_mm(bone_L, prn_L);
  if (!(height_mm >= kMinHeight_mm))
    return fail(
        ErrorCode::kAnatomyMissing,
        fmt::format("the bone ends {:.0f} mm below the most anterior point of the skin, must "
                    "be {:g} mm or more for regions without landmarks",
                    height_mm, kMinHeight_mm));
  const double subnasale_mm = prn_L.z() - 0.15 * height_mm, third_mm = 0.95 * height_mm;
  plan::Landmarks landmarks;
  const auto add = [&](const std::string& name, double half_width, double below) {
    landmarks.push_back({name, on_skin(skin_L, prn_L.x() + half_width * third_mm,
                                       subnasale_mm - below * third_mm, prn_L.y() + 20.0)});
  };
  const auto add_pair = [&](const std::string& name, double half_width, double below) {
    add(name + "-R", -half_width, below);
    add(name + "-L", half_width, below);
  };
  add("Prn", 0.0, -0.15 / 0.95);
  add("N'", 0.0, -0.75);
  add("Sn", 0.0, 0.0);
  add("Stm", 0.0, 1.0 / 3.0);
  add("Li", 0.0, 0.45);
  add("Pg'", 0.0, 0.75);
  add("Me'", 0.0, 1.0);
  add_pair("Al", 0.25, -0.05);
  add_pair("En", 0.24, -0.65);
  add_pair("Ex", 0.66, -0.65);
  add_pair("Ch", 0.37, 1.0 / 3.0);
  return landmarks;
}

}  // namespace lefort::compare
