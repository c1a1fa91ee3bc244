#include <lefort/geometry/mesh_properties.h>
#include <lefort/plan/internal/landmark_rules.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace lefort::plan::internal {
namespace {

using geometry::SurfaceCrossings;

Box3 box_of(double x0, double x1, double y0, double y1, double z0, double z1) {
  return {Vec3(x0, y0, z0), Vec3(x1, y1, z1)};
}

/// The most anterior points of the skull within `half_mm` of the mid-sagittal plane.
std::vector<Vec3> mid_profile(const SurfaceCrossings& front, double half_mm, double low_mm,
                              double high_mm) {
  return front.first_within(box_of(-half_mm, half_mm, -kFar_mm, kFar_mm, low_mm, high_mm));
}

/// The most posterior point of the profile between glabella and the end of the nasal bones.
std::optional<Extremum> find_nasion(const SurfaceCrossings& front, const FacialCavities& cavities,
                                    double voxel_mm) {
  constexpr double kAbove_mm = 22.0, kBelow_mm = 22.0, kHalf_mm = 1.0;
  const double middle_mm = cavities.orbit_center_mm(), top_mm = cavities.orbit_high_mm;
  const auto profile = mid_profile(front, kHalf_mm, middle_mm - kBelow_mm, top_mm + kAbove_mm);
  const auto glabella =
      find_extremum(between_heights(profile, top_mm, top_mm + kAbove_mm), kAnterior, voxel_mm);
  const auto rhinion = find_extremum(between_heights(profile, middle_mm - kBelow_mm, middle_mm),
                                     kAnterior, voxel_mm);
  if (!glabella || !rhinion) return std::nullopt;
  return find_extremum(between_heights(profile, rhinion->point.z(), glabella->point.z()),
                       kPosterior, voxel_mm);
}

/// The tip of the spine at the floor of the piriform aperture; if the profile only slopes to the
/// teeth there, the point at the height of the floor.
std::optional<Extremum> find_anterior_spine(const SurfaceCrossings& front, double floor_mm,
                                            double voxel_mm) {
  constexpr double kBelow_mm = 6.0, kAbove_mm = 4.0, kHalf_mm = 4.0;
  const Vec3 direction = Vec3(0.0, -0.94, 0.34).normalized();  // 20 degrees above the horizontal.
  auto tip = find_extremum(mid_profile(front, kHalf_mm, floor_mm - kBelow_mm, floor_mm + kAbove_mm),
                           direction, voxel_mm);
  if (!tip || tip->point.z() > floor_mm - kBelow_mm + voxel_mm) return tip;
  return find_extremum(
      mid_profile(front, kHalf_mm, floor_mm - 0.5 * voxel_mm, floor_mm + 0.5 * voxel_mm), kAnterior,
      voxel_mm);
}

std::optional<Extremum> find_a_point(const SurfaceCrossings& front, const Vec3& spine,
                                     double voxel_mm) {
  constexpr double kNear_mm = 7.0, kFarBelow_mm = 28.0, kHalf_mm = 1.5, kMaxOffset_mm = 15.0;
  std::vector<Vec3> profile;
  for (const Vec3& p : mid_profile(front, kHalf_mm, spine.z() - kFarBelow_mm, spine.z()))
    if (std::abs(p.y() - spine.y()) < kMaxOffset_mm) profile.push_back(p);
  const auto crest =
      find_extremum(between_heights(profile, spine.z() - kFarBelow_mm, spine.z() - kNear_mm),
                    kAnterior, voxel_mm);
  if (!crest) return std::nullopt;
  return find_deepest(profile, spine, crest->point, voxel_mm);
}

/// The bone near a height on the line through `p`: z of its lower surface, and its thickness.
struct Plate {
  double lower_mm, thickness_mm;
};

std::optional<Plate> lowest_plate(const SurfaceCrossings& above, const Vec3& p, double low_mm,
                                  double high_mm) {
  const auto z_mm = above.crossings(p);
  for (std::size_t i = 0; i + 1 < z_mm.size(); i += 2)  // From entry to exit.
    if (z_mm[i] >= low_mm && z_mm[i] <= high_mm) return Plate{z_mm[i], z_mm[i + 1] - z_mm[i]};
  return std::nullopt;
}

/// Follows the vault of the palate to posterior, until bone ends or rises to the vomer.
std::optional<Extremum> find_posterior_spine(const SurfaceCrossings& above, const Vec3& spine) {
  constexpr double kVault_mm = 22.0, kLongest_mm = 75.0, kBelow_mm = 14.0, kAbove_mm = 8.0;
  constexpr double kMaxSlope = 0.9, kOver_mm = 2.5, kMaxGap_mm = 5.0, kHalf_mm = 2.0;
  constexpr double kMaxHalfThickness_mm = 1.5, kMaxRise_mm = 0.8;
  constexpr std::size_t kMinPoints = 10;
  std::vector<Vec3> palate;  // On its lower surface; x is half of the thickness.
  for (double y = spine.y() + kVault_mm; y < spine.y() + kLongest_mm; y += kPixel_mm) {
    if (!palate.empty() && y - palate.back().y() > kMaxGap_mm) break;
    std::optional<Plate> lowest;
    for (double x = -kHalf_mm; x <= kHalf_mm; x += kPixel_mm) {
      const auto plate =
          lowest_plate(above, {x, y, spine.z()}, spine.z() - kBelow_mm, spine.z() + kAbove_mm);
      if (plate && (!lowest || plate->lower_mm < lowest->lower_mm)) lowest = plate;
    }
    if (!lowest) continue;
    const Vec3 here(std::min(0.5 * lowest->thickness_mm, kMaxHalfThickness_mm), y,
                    lowest->lower_mm);
    const auto earlier = std::find_if(palate.rbegin(), palate.rend(),
                                      [&](const Vec3& p) { return p.y() <= y - kOver_mm; });
    if (earlier != palate.rend() &&
        here.z() > earlier->z() + kMaxSlope * (here.y() - earlier->y())) {
      const double highest_mm = earlier->z() + kMaxRise_mm;
      while (palate.back().z() > highest_mm) palate.pop_back();
      break;
    }
    palate.push_back(here);
  }
  if (palate.size() < kMinPoints) return std::nullopt;
  const Vec3& last = palate.back();
  return Extremum{{0.0, last.y(), last.z() + last.x()}, 0.0};
}

/// The lowest point of the infraorbital rim: in each sagittal section, the rim is the point that is
/// furthest in the direction between anterior and superior.
std::optional<Extremum> find_orbitale(const SurfaceCrossings& front, const FacialCavities& cavities,
                                      std::size_t side, double voxel_mm) {
  constexpr double kHalfWidth_mm = 11.0, kBelow_mm = 14.0;
  const Vec3 outwards = Vec3(0.0, -1.0, 1.0).normalized();
  const double middle_mm = cavities.orbit_center_x_mm[side];
  std::vector<Vec3> rim;
  for (double x = middle_mm - kHalfWidth_mm; x <= middle_mm + kHalfWidth_mm; x += kPixel_mm) {
    std::optional<Vec3> best;
    for (double z = cavities.orbit_center_mm() - 4.0; z > cavities.orbit_low_mm - kBelow_mm;
         z -= kPixel_mm)
      if (const auto p = front.first({x, 0.0, z}))
        if (!best || outwards.dot(*p) > outwards.dot(*best)) best = p;
    if (best) rim.push_back(*best);
  }
  return find_extremum(rim, kInferior, voxel_mm);
}

/// The most anterior point of the lateral rim at the height of the suture: 11 mm above Whitnall's
/// tubercle, which is at the middle of the orbit \cite whitnall1911, for an orbit of 36 mm.
std::optional<Extremum> find_frontozygomatic(const SurfaceCrossings& front,
                                             const FacialCavities& cavities, const Side& side,
                                             double voxel_mm) {
  constexpr double kHeight = 0.5 + 11.0 / 36.0;  // Of the orbit, from its floor.
  constexpr double kFrom_mm = 12.0, kTo_mm = 30.0, kHalf_mm = 1.0;
  const double z_mm =
      cavities.orbit_low_mm + kHeight * (cavities.orbit_high_mm - cavities.orbit_low_mm);
  const double middle_mm = std::abs(cavities.orbit_center_x_mm[side.sign > 0.0 ? 1 : 0]);
  const double one = side.sign * (middle_mm + kFrom_mm), two = side.sign * (middle_mm + kTo_mm);
  return find_extremum(front.first_within(box_of(std::min(one, two), std::max(one, two), -kFar_mm,
                                                 kFar_mm, z_mm - kHalf_mm, z_mm + kHalf_mm)),
                       kAnterior, voxel_mm);
}

/// Upper incisor and first molars: lowest points of the teeth, or of the maxilla with its teeth.
void find_upper_teeth(const HeadInF& head, LandmarkList& list) {
  constexpr double kHalf_mm = 6.0, kMinBelow_mm = 17.0, kMaxBelow_mm = 40.0;
  constexpr double kAhead_mm = 14.0, kBehind_mm = 12.0;
  const auto a_point = list.at("A"), spine = list.at("ANS");
  const std::string none = "no upper teeth below the A point";
  if (!a_point || !spine) {
    for (const char* const name : {"U1", "U6-R", "U6-L"}) list.miss(name, "no A point");
    return;
  }
  const geometry::TriangleMesh& teeth = head.upper_teeth ? *head.upper_teeth : head.skull;
  const Box3 box =
      box_of(-45.0, 45.0, a_point->y() - kAhead_mm, a_point->y() + 60.0, spine->z() - kMaxBelow_mm,
             spine->z() - (head.upper_teeth ? 0.0 : kMinBelow_mm));
  const SurfaceCrossings below(teeth, 2, box, kPixel_mm);
  const auto incisor =
      find_extremum(below.first_within(box_of(-kHalf_mm, kHalf_mm, a_point->y() - kAhead_mm,
                                              a_point->y() + kBehind_mm, -kFar_mm, kFar_mm)),
                    kUpperIncisorAxis, list.voxel_mm());
  list.add("U1", incisor, 0.5, none);
  const auto found = list.at("U1");
  for (const Side& side : kSides) {
    const std::string name = std::string("U6") + side.suffix;
    if (!found) {
      list.miss(name, none);
      continue;
    }
    // The mesiobuccal cusp: 25 to 33 mm behind the incisors, at the height of the occlusion.
    const double one = 18.0 * side.sign, two = 36.0 * side.sign;
    const Vec3 direction = Vec3(0.35 * side.sign, 0.0, -0.94).normalized();
    list.add(name,
             find_extremum(below.first_within(box_of(std::min(one, two), std::max(one, two),
                                                     found->y() + 25.0, found->y() + 33.0,
                                                     found->z() - 6.0, found->z() + 10.0)),
                           direction, list.voxel_mm()),
             3.0, "no molar at the height of the incisors");
  }
}

}  // namespace

void find_midface(const HeadInF& head, const SurfaceCrossings& front,
                  const std::optional<FacialCavities>& cavities, LandmarkList& list) {
  const double voxel_mm = list.voxel_mm();
  if (!cavities) {
    for (const char* const name :
         {"N", "Or-R", "Or-L", "FZ-R", "FZ-L", "ANS", "A", "PNS", "U1", "U6-R", "U6-L"})
      list.miss(name, "no orbits in the skull");
    return;
  }
  list.add("N", find_nasion(front, *cavities, voxel_mm), 0.5, "no nasal root between the orbits");
  for (std::size_t side = 0; side < 2; ++side) {
    list.add(std::string("Or") + kSides[side].suffix,
             find_orbitale(front, *cavities, side, voxel_mm), 0.5, "no infraorbital rim");
    list.add(std::string("FZ") + kSides[side].suffix,
             find_frontozygomatic(front, *cavities, kSides[side], voxel_mm), 3.0,
             "no lateral orbital rim");
  }
  std::optional<Extremum> spine, a_point, posterior;
  if (cavities->aperture_low_mm)
    spine = find_anterior_spine(front, *cavities->aperture_low_mm, voxel_mm);
  if (spine) {
    a_point = find_a_point(front, spine->point, voxel_mm);
    const Vec3& p = spine->point;
    const SurfaceCrossings above(head.skull, 2,
                                 box_of(-5.0, 5.0, p.y(), p.y() + 80.0, p.z() - 40.0, p.z() + 40.0),
                                 kPixel_mm);
    posterior = find_posterior_spine(above, p);
  }
  list.add("ANS", spine, 0.5, "no floor of the piriform aperture");
  list.add("A", a_point, 0.5, "no concavity below ANS");
  list.add("PNS", posterior, 1.0, "the hard palate is not followed from ANS");
  find_upper_teeth(head, list);
}

}  // namespace lefort::plan::internal
