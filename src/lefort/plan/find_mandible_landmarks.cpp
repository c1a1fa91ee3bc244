#include <lefort/geometry/mesh_properties.h>
#include <lefort/plan/internal/landmark_rules.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace lefort::plan::internal {
namespace {

using geometry::SurfaceCrossings;
using geometry::TriangleMesh;

/// Vertices of the chin: the most anterior 30 mm.
std::vector<Vec3> chin_of(const TriangleMesh& mandible, const Box3& box) {
  constexpr double kDepth_mm = 30.0;
  std::vector<Vec3> chin;
  for (const Vec3& v : mandible.vertices)
    if (v.y() < box.min().y() + kDepth_mm) chin.push_back(v);
  return chin;
}

/// The middle of the chin: the mean of its lateral limits 6 to 14 mm behind its front, in the lower
/// half, where there are no teeth.
double middle_of(const std::vector<Vec3>& chin, double voxel_mm) {
  double front_mm = 1e9, low_mm = 1e9, high_mm = -1e9;
  for (const Vec3& v : chin) {
    low_mm = std::min(low_mm, v.z());
    high_mm = std::max(high_mm, v.z());
  }
  const double half_mm = 0.5 * (low_mm + high_mm);
  for (const Vec3& v : chin)
    if (v.z() < half_mm) front_mm = std::min(front_mm, v.y());
  double sum = 0.0, count = 0.0;
  for (double from_mm = 6.0; from_mm < 14.0; from_mm += voxel_mm) {
    double right_mm = 1e9, left_mm = -1e9;
    for (const Vec3& v : chin)
      if (v.z() < half_mm && v.y() >= front_mm + from_mm && v.y() < front_mm + from_mm + voxel_mm) {
        right_mm = std::min(right_mm, v.x());
        left_mm = std::max(left_mm, v.x());
      }
    if (left_mm < right_mm) continue;
    sum += 0.5 * (left_mm + right_mm);
    count += 1.0;
  }
  return count > 0.0 ? sum / count : 0.0;
}

/// L1, B, Pg, Gn and Me in the middle of the chin.
void find_symphysis(const HeadInF& head, const Box3& box, LandmarkList& list) {
  constexpr double kHalf_mm = 3.0, kDepth_mm = 22.0, kLower_mm = 24.0, kTeeth_mm = 22.0,
                   kTeethDepth_mm = 18.0;
  const double voxel_mm = list.voxel_mm();
  const double middle_mm = middle_of(chin_of(*head.mandible, box), voxel_mm);
  const Box3 window(Vec3(middle_mm - 8.0, box.min().y() - 1.0, box.min().z() - 1.0),
                    Vec3(middle_mm + 8.0, box.min().y() + 45.0, box.max().z() + 1.0));
  const SurfaceCrossings front(*head.mandible, 1, window, kPixel_mm);
  const SurfaceCrossings below(*head.mandible, 2, window, kPixel_mm);
  const auto strip = [&](double half_mm) {
    return Box3(Vec3(middle_mm - half_mm, window.min().y(), window.min().z()),
                Vec3(middle_mm + half_mm, window.max().y(), window.max().z()));
  };
  const std::vector<Vec3> profile = front.first_within(strip(kHalf_mm));
  std::vector<Vec3> underside;
  for (const Vec3& p : below.first_within(strip(kHalf_mm)))
    if (p.y() < box.min().y() + kDepth_mm) underside.push_back(p);
  const auto menton = find_extremum(underside, kInferior, voxel_mm);
  if (!menton) {
    for (const char* const name : {"Me", "Pg", "Gn", "B", "L1"})
      list.miss(name, "no chin in the middle of the mandible");
    return;
  }
  const double low_mm = menton->point.z();
  const auto lower = between_heights(profile, low_mm, low_mm + kLower_mm);
  // The point of the chin, not the alveolar process above it: along the facial line of most faces.
  const auto pogonion =
      find_extremum(between_heights(lower, low_mm, low_mm + 0.75 * kLower_mm), kAnterior, voxel_mm);
  std::vector<Vec3> outline = lower;
  outline.insert(outline.end(), underside.begin(), underside.end());
  const auto gnathion = find_extremum(outline, Vec3(0.0, -1.0, -1.0).normalized(), voxel_mm);
  const TriangleMesh& teeth = head.lower_teeth ? *head.lower_teeth : *head.mandible;
  const SurfaceCrossings above(teeth, 2, window, kPixel_mm);
  Box3 incisors = strip(6.0);
  incisors.max().y() = box.min().y() + kTeethDepth_mm;
  auto incisor = find_extremum(above.last_within(incisors), kLowerIncisorAxis, voxel_mm);
  if (incisor && incisor->point.z() < low_mm + 1.5 * kTeeth_mm) incisor.reset();
  const auto crest = find_extremum(between_heights(profile, low_mm + kTeeth_mm, box.max().z()),
                                   kAnterior, voxel_mm);
  std::optional<Extremum> b_point;
  if (pogonion && crest) b_point = find_deepest(profile, pogonion->point, crest->point, voxel_mm);
  list.add("Me", menton, 0.5, "no chin");
  list.add("Pg", pogonion, 0.5, "no chin");
  list.add("Gn", gnathion, 0.5, "no chin");
  list.add("B", b_point, 0.5, "no concavity above the chin");
  list.add("L1", incisor, 0.5, "no lower teeth above the chin");
}

std::vector<Vec3> side_of(const TriangleMesh& mandible, const Box3& box, double sign) {
  constexpr double kMinLateral_mm = 20.0, kMinBehind_mm = 35.0;
  std::vector<Vec3> points;
  for (const Vec3& v : mandible.vertices)
    if (sign * v.x() > kMinLateral_mm && v.y() > box.min().y() + kMinBehind_mm) points.push_back(v);
  return points;
}

/// Where the bisector of the tangents to the posterior border of the ramus and to the lower border
/// of the body meets the angle: the extremum along that bisector.
std::optional<Extremum> find_gonion(const std::vector<Vec3>& side, const Vec3& condyle,
                                    const Vec3& menton, double voxel_mm) {
  constexpr int kIterations = 4;
  Vec3 direction = Vec3(0.0, 1.0, -1.0).normalized();
  std::optional<Extremum> found = find_extremum(side, direction, voxel_mm);
  for (int iteration = 0; found && iteration < kIterations; ++iteration) {
    const Vec3 ramus = condyle - found->point, body = menton - found->point;
    const Vec3 behind = Vec3(0.0, ramus.z(), -ramus.y()).normalized();
    const Vec3 below = Vec3(0.0, -body.z(), body.y()).normalized();
    direction = (behind + below).normalized();
    if (!(direction.y() > 0.0 && direction.z() < 0.0)) break;
    found = find_extremum(side, direction, voxel_mm);
  }
  return found;
}

/// The top of the condyle. Seen obliquely from behind the coronoid process is lower.
std::optional<Extremum> find_condylion(const std::vector<Vec3>& side, double voxel_mm) {
  constexpr double kRadius_mm = 14.0;
  const auto region = find_extremum(side, Vec3(0.0, 0.5, 0.87).normalized(), voxel_mm);
  if (!region) return std::nullopt;
  std::vector<Vec3> head;
  for (const Vec3& p : side)
    if ((p - region->point).norm() < kRadius_mm) head.push_back(p);
  return find_extremum(head, kSuperior, voxel_mm);
}

/// The poles of the condyle: the most lateral and the most medial point of its head, which is wider
/// than its neck \cite martin1957.
void find_condylar_poles(const std::vector<Vec3>& points, const std::optional<Extremum>& condyle,
                         const Side& side, LandmarkList& list) {
  constexpr double kHeight_mm = 10.0, kRadius_mm = 18.0;
  const std::string lateral = std::string("Cdl") + side.suffix;
  const std::string medial = std::string("Cdm") + side.suffix;
  std::vector<Vec3> head;
  for (const Vec3& p : points)
    if (condyle && p.z() > condyle->point.z() - kHeight_mm &&
        (p - condyle->point).norm() < kRadius_mm)
      head.push_back(p);
  const Vec3 outwards(side.sign, 0.0, 0.0);
  list.add(lateral, find_extremum(head, outwards, list.voxel_mm()), 0.5, "no condyle");
  list.add(medial, find_extremum(head, -outwards, list.voxel_mm()), 0.5, "no condyle");
}

/// The mesiobuccal cusp: 21 to 30 mm behind the incisors, at the height of the occlusion.
void find_lower_molar(const HeadInF& head, const Side& side, LandmarkList& list) {
  const std::string name = std::string("L6") + side.suffix;
  const auto incisor = list.at("L1");
  if (!incisor) return list.miss(name, "no lower incisors");
  const double one = 15.0 * side.sign, two = 34.0 * side.sign;
  const Box3 box(Vec3(std::min(one, two), incisor->y() + 21.0, incisor->z() - 12.0),
                 Vec3(std::max(one, two), incisor->y() + 30.0, incisor->z() + 6.0));
  const SurfaceCrossings above(head.lower_teeth ? *head.lower_teeth : *head.mandible, 2, box,
                               kPixel_mm);
  list.add(name,
           find_extremum(above.last_within(box), Vec3(0.35 * side.sign, 0.0, 0.94).normalized(),
                         list.voxel_mm()),
           3.0, "no molar at the height of the incisors");
}

}  // namespace

void find_mandible_landmarks(const HeadInF& head, LandmarkList& list) {
  constexpr double kMinDepth_mm = 60.0;  // From chin to ramus.
  const std::string none = "no mandible in the labels";
  const bool is_there =
      head.mandible && geometry::bounding_box(*head.mandible).sizes().y() > kMinDepth_mm;
  if (!is_there) {
    for (const char* const name : {"Me", "Pg", "Gn", "B", "L1", "Co-R", "Co-L", "Cdl-R", "Cdl-L",
                                   "Cdm-R", "Cdm-L", "Go-R", "Go-L", "L6-R", "L6-L"})
      list.miss(name, none);
    return;
  }
  const Box3 box = geometry::bounding_box(*head.mandible);
  find_symphysis(head, box, list);
  for (const Side& side : kSides) {
    const std::vector<Vec3> points = side_of(*head.mandible, box, side.sign);
    const auto condyle = find_condylion(points, list.voxel_mm());
    list.add(std::string("Co") + side.suffix, condyle, 0.5, "no ramus on that side");
    find_condylar_poles(points, condyle, side, list);
    const auto menton = list.at("Me");
    std::optional<Extremum> gonion;
    if (condyle && menton) gonion = find_gonion(points, condyle->point, *menton, list.voxel_mm());
    list.add(std::string("Go") + side.suffix, gonion, 1.0, "no ramus or no menton");
    find_lower_molar(head, side, list);
  }
}

}  // namespace lefort::plan::internal
