#include <lefort/geometry/mesh_properties.h>
#include <lefort/plan/internal/landmark_rules.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace lefort::plan::internal {
namespace {

using geometry::SurfaceCrossings;

/// The face as seen from the front.
class Face {
 public:
  Face(const geometry::TriangleMesh& skin, double voxel_mm)
      : front_(skin, 1, geometry::bounding_box(skin), kPixel_mm), voxel_mm_(voxel_mm) {}

  [[nodiscard]] const SurfaceCrossings& front() const { return front_; }
  [[nodiscard]] double voxel_mm() const { return voxel_mm_; }

  /// The profile in the mid-sagittal plane, from inferior to superior.
  [[nodiscard]] std::vector<Vec3> profile(double low_mm, double high_mm, double x_mm = 0.0) const {
    std::vector<Vec3> points;
    for (double z = low_mm; z <= high_mm; z += kPixel_mm)
      if (const auto p = front_.first({x_mm, 0.0, z})) points.push_back(*p);
    return points;
  }
  /// One axial section, from medial to lateral.
  [[nodiscard]] std::vector<Vec3> row(double z_mm, double sign, double from_mm,
                                      double to_mm) const {
    std::vector<Vec3> points;
    for (double x = from_mm; x <= to_mm; x += kPixel_mm)
      if (const auto p = front_.first({sign * x, 0.0, z_mm})) points.push_back(*p);
    return points;
  }

 private:
  SurfaceCrossings front_;
  double voxel_mm_;
};

/// The tip of the nose: the most anterior point of the profile, counting also how far the face
/// recedes 18 mm lateral to it, which distinguishes the nose from forehead and chin.
std::optional<Extremum> find_pronasale(const Face& face, double low_mm, double high_mm) {
  constexpr double kLateral_mm = 18.0, kHalfWidth_mm = 8.0, kHalfHeight_mm = 12.0;
  std::optional<Vec3> seed;
  double best_mm = -std::numeric_limits<double>::infinity();
  for (const Vec3& p : face.profile(low_mm, high_mm)) {
    const auto right = face.front().first({-kLateral_mm, 0.0, p.z()});
    const auto left = face.front().first({kLateral_mm, 0.0, p.z()});
    if (!right || !left) continue;
    const double value_mm = -p.y() + 0.5 * (right->y() + left->y()) - p.y();
    if (value_mm <= best_mm) continue;
    best_mm = value_mm;
    seed = p;
  }
  if (!seed) return std::nullopt;
  const Vec3 half(kHalfWidth_mm, kFar_mm, kHalfHeight_mm);
  return find_extremum(face.front().first_within(Box3(*seed - half, *seed + half)), kAnterior,
                       face.voxel_mm());
}

std::optional<Extremum> find_soft_nasion(const Face& face, const Vec3& tip) {
  const auto profile = face.profile(tip.z() + 12.0, tip.z() + 80.0);
  const auto glabella = find_extremum(between_heights(profile, tip.z() + 48.0, tip.z() + 75.0),
                                      kAnterior, face.voxel_mm());
  if (!glabella) return std::nullopt;
  return find_extremum(between_heights(profile, tip.z(), glabella->point.z()), kPosterior,
                       face.voxel_mm());
}

/// How much deeper a point of a profile is than the points within a distance on both sides of it.
double notch_mm(const std::vector<Vec3>& profile, std::size_t at, double within_mm) {
  const auto reach = std::ptrdiff_t(within_mm / kPixel_mm);
  const auto count = std::ptrdiff_t(profile.size()), i = std::ptrdiff_t(at);
  double before = profile[at].y(), after = profile[at].y();
  for (std::ptrdiff_t k = std::max<std::ptrdiff_t>(0, i - reach); k < i; ++k)
    before = std::min(before, profile[std::size_t(k)].y());
  for (std::ptrdiff_t k = i + 1; k < std::min(count, i + reach + 1); ++k)
    after = std::min(after, profile[std::size_t(k)].y());
  return profile[at].y() - std::max(before, after);
}

/// The deepest narrow notch of a profile.
struct Notch {
  Vec3 point;
  double depth_mm;
};

std::optional<Notch> find_notch(const std::vector<Vec3>& profile, double within_mm,
                                double min_depth_mm) {
  std::optional<Notch> best;
  for (std::size_t i = 0; i < profile.size(); ++i) {
    const double depth_mm = notch_mm(profile, i, within_mm);
    if (depth_mm >= min_depth_mm && (!best || depth_mm > best->depth_mm))
      best = Notch{profile[i], depth_mm};
  }
  return best;
}

constexpr double kNotchWithin_mm = 6.0, kMinNotch_mm = 0.4;

/// The line between the lips, and the direction from which it is a notch.
struct Mouth {
  Vec3 stomion, posterior;
};

/// The deepest notch of the profile below the nose. If the lower lip recedes so far that there is
/// none as seen from the front, that as seen along the normal of the line from lip to chin.
std::optional<Mouth> find_mouth(const std::vector<Vec3>& profile, const Vec3& base,
                                const std::optional<Extremum>& lip,
                                const std::optional<Extremum>& chin) {
  const std::vector<Vec3> heights = between_heights(profile, base.z() - 34.0, base.z() - 10.0);
  if (const auto notch = find_notch(heights, kNotchWithin_mm, kMinNotch_mm))
    return Mouth{notch->point, kPosterior};
  if (!lip || !chin || !(lip->point.z() > chin->point.z())) return std::nullopt;
  const Vec3 chord = lip->point - chin->point;
  const Vec3 posterior = Vec3(0.0, chord.z(), -chord.y()).normalized();
  std::vector<Vec3> leaned = heights;
  for (Vec3& p : leaned) p.y() = posterior.dot(p);
  const auto notch = find_notch(leaned, kNotchWithin_mm, kMinNotch_mm);
  if (!notch) return std::nullopt;
  const auto stomion = std::find_if(heights.begin(), heights.end(),
                                    [&](const Vec3& p) { return p.z() == notch->point.z(); });
  return Mouth{*stomion, posterior};
}

/// The chin near the height of pogonion on bone; without one, below the mouth.
std::optional<Extremum> find_soft_pogonion(const std::vector<Vec3>& profile,
                                           const std::optional<Vec3>& bone,
                                           const std::optional<double>& mouth_mm, double voxel_mm) {
  if (!bone && !mouth_mm) return std::nullopt;
  const double chin_mm = bone ? bone->z() : *mouth_mm - 33.0;
  double high_mm = chin_mm + 8.0;
  if (mouth_mm) high_mm = std::min(high_mm, *mouth_mm - 20.0);
  return find_extremum(between_heights(profile, chin_mm - 10.0, high_mm), kAnterior, voxel_mm);
}

void find_lips(const std::vector<Vec3>& profile, const Vec3& base, const Mouth& mouth,
               LandmarkList& list) {
  const double voxel_mm = list.voxel_mm(), mouth_mm = mouth.stomion.z();
  const auto upper =
      find_extremum(between_heights(profile, mouth_mm, mouth_mm + 0.65 * (base.z() - mouth_mm)),
                    kAnterior, voxel_mm);
  const auto lower = find_extremum(between_heights(profile, mouth_mm - 14.0, mouth_mm),
                                   -mouth.posterior, voxel_mm);
  const auto bone = list.at("Pg");
  const auto pogonion = find_soft_pogonion(profile, bone, mouth_mm, voxel_mm);
  list.add("Stm", Extremum{mouth.stomion, 0.5}, 0.5, "");
  list.add("Ls", upper, 1.5, "no upper lip");
  list.add("Li", lower, 1.5, "no lower lip");
  if (upper) list.add("A'", find_deepest(profile, upper->point, base, voxel_mm), 0.5, "");
  list.add("Pg'", pogonion, bone ? 0.5 : 2.0, "the skin ends above the chin");
  if (pogonion && lower)
    list.add("B'", find_deepest(profile, pogonion->point, lower->point, voxel_mm), 0.5, "no fold");
}

void find_nose_and_lips(const Face& face, const Vec3& tip, LandmarkList& list) {
  constexpr double kChinBelow_mm = 120.0;  // From Prn to below the chin of a long face.
  const double voxel_mm = face.voxel_mm();
  const auto profile = face.profile(tip.z() - kChinBelow_mm, tip.z());
  const auto lip =
      find_extremum(between_heights(profile, tip.z() - 34.0, tip.z() - 18.0), kAnterior, voxel_mm);
  std::optional<Extremum> subnasale;
  if (lip) subnasale = find_deepest(profile, {0.0, tip.y(), tip.z()}, lip->point, voxel_mm);
  list.add("Sn", subnasale, 0.5, "the skin ends below the nose");
  const auto base = list.at("Sn");
  const auto chin = find_soft_pogonion(profile, list.at("Pg"), std::nullopt, voxel_mm);
  std::optional<Mouth> mouth;
  if (base) mouth = find_mouth(profile, *base, lip, chin);
  if (mouth) return find_lips(profile, *base, *mouth, list);
  const std::string reason = base ? "no notch between the lips" : "no subnasale";
  for (const char* const name : {"Stm", "Ls", "Li", "A'", "B'"}) list.miss(name, reason);
  list.add("Pg'", chin, 1.5, reason);
}

/// The skin below menton.
void find_soft_menton(const geometry::TriangleMesh& skin, LandmarkList& list) {
  const auto menton = list.at("Me");
  if (!menton) return list.miss("Me'", "no menton");
  const SurfaceCrossings lines(
      skin, 2, Box3(*menton - Vec3(2.0, 2.0, 30.0), *menton + Vec3(2.0, 2.0, 0.0)), kPixel_mm);
  const auto below = lines.last(*menton);
  list.add("Me'", below ? std::optional(Extremum{*below, 1.0}) : std::nullopt, 1.5,
           "no skin within 30 mm below menton");
}

/// The wall of the ala is the last steep part of an axial section; its most lateral point is within
/// the largest step, behind which the groove between ala and cheek is hidden from the front.
std::optional<Extremum> find_alare(const Face& face, const Vec3& tip, const Vec3& base,
                                   const Side& side) {
  constexpr double kFrom_mm = 5.0, kTo_mm = 28.0, kMinSlope = 1.2;
  // Depth within half a pixel of the silhouette of a wall with a radius of 8 mm.
  constexpr double kWithinPixel_mm = 2.0;
  std::vector<Vec3> walls;
  for (double z = base.z() + 2.0; z <= tip.z() + 3.0; z += kPixel_mm) {
    const auto row = face.row(z, side.sign, kFrom_mm, kTo_mm);
    std::optional<Vec3> wall;
    double max_step_mm = 0.0;
    bool is_in_wall = false;
    for (std::size_t i = 0; i + 1 < row.size(); ++i) {
      const double step_mm = row[i + 1].y() - row[i].y();
      const bool is_steep = step_mm > kMinSlope * kPixel_mm;
      if (is_steep && (!is_in_wall || step_mm > max_step_mm)) {
        max_step_mm = step_mm;
        wall = row[i];
        wall->y() += std::min(0.5 * step_mm, kWithinPixel_mm);
      }
      is_in_wall = is_steep;
    }
    if (wall) walls.push_back(*wall);
  }
  return find_extremum(walls, Vec3(side.sign, 0.0, 0.0), face.voxel_mm());
}

/// Follows the notch between the lips laterally to where its depth falls below a quarter of the
/// median depth in the middle.
std::optional<Extremum> find_cheilion(const Face& face, const Vec3& stomion, double sign) {
  constexpr double kMax_mm = 40.0, kMin_mm = 12.0, kHalf_mm = 5.0, kMaxGap_mm = 2.0;
  constexpr double kSharp_mm = 3.0;  // The line between the lips is narrower than other folds.
  constexpr double kDepthFraction = 0.25;
  Vec3 last = stomion;
  std::vector<double> depths_mm;
  double min_depth_mm = kMinNotch_mm;
  for (double x = kPixel_mm; x < kMax_mm; x += kPixel_mm) {
    if (x - sign * last.x() > kMaxGap_mm) break;
    const auto around = face.profile(last.z() - kHalf_mm - kNotchWithin_mm,
                                     last.z() + kHalf_mm + kNotchWithin_mm, sign * x);
    const std::optional<Notch> notch = find_notch(around, kSharp_mm, min_depth_mm);
    if (!notch || std::abs(notch->point.z() - last.z()) >= kHalf_mm) continue;
    last = notch->point;
    if (x >= kMin_mm) continue;
    depths_mm.push_back(notch->depth_mm);
    const auto middle = depths_mm.begin() + std::ptrdiff_t(depths_mm.size() / 2);
    std::nth_element(depths_mm.begin(), middle, depths_mm.end());
    min_depth_mm = std::max(kMinNotch_mm, kDepthFraction * *middle);
  }
  if (sign * last.x() < kMin_mm) return std::nullopt;
  return Extremum{last, 1.0};
}

/// The most posterior point beside the nose at the height of the eye.
std::optional<Extremum> find_endocanthion(const Face& face, double eye_mm, double globe_mm,
                                          double sign) {
  constexpr double kHalfHeight_mm = 4.0, kFrom_mm = 8.0, kBeforeGlobe_mm = 8.0;
  std::vector<Vec3> points;
  for (double z = eye_mm - kHalfHeight_mm; z <= eye_mm + kHalfHeight_mm; z += kPixel_mm)
    for (const Vec3& p : face.row(z, sign, kFrom_mm, globe_mm - kBeforeGlobe_mm))
      points.push_back(p);
  return find_extremum(points, kPosterior, face.voxel_mm());
}

/// Lateral to the eye, the point of the axial sections with the largest concavity over 4 mm.
std::optional<Extremum> find_exocanthion(const Face& face, double eye_mm, double globe_mm,
                                         double sign) {
  constexpr double kHalfHeight_mm = 4.0, kFrom_mm = 4.0, kTo_mm = 22.0, kMinDepth_mm = 0.2;
  constexpr std::size_t kReach = 8;  // Pixels.
  std::optional<Extremum> best;
  double deepest_mm = kMinDepth_mm;
  for (double z = eye_mm - kHalfHeight_mm; z <= eye_mm + kHalfHeight_mm; z += kPixel_mm) {
    const auto row = face.row(z, sign, globe_mm + kFrom_mm, globe_mm + kTo_mm);
    for (std::size_t i = kReach; i + kReach < row.size(); ++i) {
      const double depth_mm = row[i].y() - 0.5 * (row[i - kReach].y() + row[i + kReach].y());
      if (depth_mm <= deepest_mm) continue;
      deepest_mm = depth_mm;
      best = Extremum{row[i], 1.0};
    }
  }
  return best;
}

void find_eyes(const Face& face, const std::optional<FacialCavities>& cavities, const Vec3& tip,
               const std::optional<Vec3>& root, LandmarkList& list) {
  const double eye_mm = cavities ? cavities->orbit_center_mm()
                                 : tip.z() + 0.7 * ((root ? root->z() : tip.z() + 42.0) - tip.z());
  for (std::size_t n = 0; n < 2; ++n) {
    const Side& side = kSides[n];
    const double globe_mm = cavities ? std::abs(cavities->orbit_center_x_mm[n]) : 32.0;
    list.add(std::string("En") + side.suffix, find_endocanthion(face, eye_mm, globe_mm, side.sign),
             2.0, "no skin beside the nose at the height of the orbits");
    list.add(std::string("Ex") + side.suffix, find_exocanthion(face, eye_mm, globe_mm, side.sign),
             4.0, "no concavity lateral to the eye");
  }
}

}  // namespace

void find_skin_landmarks(const HeadInF& head, const std::optional<FacialCavities>& cavities,
                         LandmarkList& list) {
  constexpr double kAbove_mm = 5.0, kBelow_mm = 75.0;
  const char* const kAll[] = {"Prn", "N'", "Sn", "Stm", "Ls", "Li", "A'", "B'", "Pg'", "Me'"};
  const char* const kPairs[] = {"Al", "Ch", "En", "Ex"};
  const auto miss_all = [&](const std::string& reason) {
    for (const char* const name : kAll)
      if (!list.at(name)) list.miss(name, reason);
    for (const char* const name : kPairs)
      for (const Side& side : kSides) list.miss(std::string(name) + side.suffix, reason);
  };
  if (!head.skin) return miss_all("no skin");
  const Face face(*head.skin, list.voxel_mm());
  const Box3 box = geometry::bounding_box(*head.skin);
  const auto tip_found = cavities ? find_pronasale(face, cavities->orbit_center_mm() - kBelow_mm,
                                                   cavities->orbit_high_mm + kAbove_mm)
                                  : find_pronasale(face, box.min().z(), box.max().z());
  if (!tip_found) return miss_all("no nose");
  list.add("Prn", tip_found, 0.5, "");
  const Vec3 tip = tip_found->point;
  list.add("N'", find_soft_nasion(face, tip), 0.5, "no nasal root above the nose");
  find_nose_and_lips(face, tip, list);
  find_soft_menton(*head.skin, list);
  const auto base = list.at("Sn"), stomion = list.at("Stm");
  for (const Side& side : kSides) {
    list.add(std::string("Al") + side.suffix,
             base ? find_alare(face, tip, *base, side) : std::nullopt, 1.0,
             "no groove between nose and cheek");
    list.add(std::string("Ch") + side.suffix,
             stomion ? find_cheilion(face, *stomion, side.sign) : std::nullopt, 2.5,
             "the notch between the lips is not followed");
  }
  find_eyes(face, cavities, tip, list.at("N'"), list);
}

}  // namespace lefort::plan::internal
