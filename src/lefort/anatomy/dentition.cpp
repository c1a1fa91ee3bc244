#include <lefort/anatomy/dentition.h>
#include <lefort/anatomy/implicit_shapes.h>
#include <lefort/core/check.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>

namespace lefort::anatomy {
namespace {

using implicit::cone;
using implicit::join;

/// Heights of the crown, lengths of the root, widths and depths, from the central incisor to the
/// second molar, of \cite nelson2010 from memory; to be compared with the book. [mm]
struct ToothSize {
  double crown, root, width, neck_width, depth, neck_depth;
};
constexpr std::array<ToothSize, 7> kUpperSizes{{{10.5, 13.0, 8.5, 7.0, 7.0, 6.0},
                                                {9.0, 13.0, 6.5, 5.0, 6.0, 5.0},
                                                {10.0, 17.0, 7.5, 5.5, 8.0, 7.0},
                                                {8.5, 14.0, 7.0, 5.0, 9.0, 8.0},
                                                {8.5, 14.0, 7.0, 5.0, 9.0, 8.0},
                                                {7.5, 12.0, 10.0, 8.0, 11.0, 10.0},
                                                {7.0, 11.0, 9.0, 7.0, 11.0, 10.0}}};
constexpr std::array<ToothSize, 7> kLowerSizes{{{9.0, 12.5, 5.0, 3.5, 6.0, 5.3},
                                                {9.5, 14.0, 5.5, 4.0, 6.5, 5.8},
                                                {11.0, 16.0, 7.0, 5.5, 7.5, 7.0},
                                                {8.5, 14.0, 7.0, 5.0, 7.5, 6.5},
                                                {8.0, 14.5, 7.0, 5.0, 8.0, 7.0},
                                                {7.5, 14.0, 11.0, 9.0, 10.5, 9.0},
                                                {7.0, 13.0, 10.5, 8.0, 10.0, 9.0}}};
/// Inclinations of the crowns to buccal and heights of their tips, typical of class I; heuristic.
constexpr std::array<double, 7> kUpperTilt_deg{20, 18, 10, 4, 3, 2, 2};
constexpr std::array<double, 7> kLowerTilt_deg{18, 16, 8, -2, -6, -9, -11};
constexpr std::array<double, 7> kUpperTip_mm{-52.0, -51.5, -52.0, -51.5, -51.5, -51.5, -51.3};
constexpr std::array<double, 7> kLowerTip_mm{-50.0, -49.8, -49.1, -48.7, -48.9, -49.0, -49.1};

/// The ellipse of the contacts, half in front of its center. The lower one lies inside by the
/// distance of the lower buccal cusps from the upper ones.
constexpr double kCenter_mm = -48.0, kUpperHalf_mm = 27.0, kUpperDepth_mm = 46.0;
constexpr double kInside_mm = 2.4;
/// Neighbors overlap by this, so that they touch when rotated.
constexpr double kContact_mm = 0.1;
/// Contacts lie at this fraction of the crown height.
constexpr double kContactHeight = 0.62;
constexpr double kFacetGap_mm = 0.02;
constexpr double kFurcation_mm = 4.0;  // Below the neck.
constexpr double kSocketBone_mm = 1.4, kCrest_mm = 1.5;
constexpr double kEnamel_mm = 1.3;
constexpr double kToothReach_mm = 4.0;  // From the sphere around a tooth.

bool is_molar(const ToothForm& tooth) { return tooth.fdi % 10 >= 6; }
bool is_front(const ToothForm& tooth) { return tooth.fdi % 10 <= 3; }

double squared_mm2(double mm) { return mm * mm; }

double smooth_step(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

/// Intersection with rounded edges.
double meet(double a, double b, double width) { return -join(-a, -b, width); }

/// A superellipse with half axes a, b.
double superellipse(double x, double y, double a, double b, double exponent) {
  const double u = std::abs(x) / a, v = std::abs(y) / b;
  const double f = std::pow(std::pow(u, exponent) + std::pow(v, exponent), 1.0 / exponent);
  if (f < 0.3) return std::min(a, b) * (1.0 - f);
  const double slope =
      std::hypot(std::pow(u / f, exponent - 1.0) / a, std::pow(v / f, exponent - 1.0) / b);
  return std::min((1.0 - f) / slope, std::min(a, b));
}

/// Half the width at a height above the neck.
double half_width(const ToothForm& t, double z) {
  if (z < 0.0) return 0.5 * t.neck_width_mm * (1.0 - 0.72 * std::pow(-z / t.root_mm, 1.4));
  const double contact_mm = kContactHeight * t.crown_mm;
  const double above = std::max(0.0, (z - contact_mm) / (t.crown_mm - contact_mm));
  return 0.5 * (t.neck_width_mm + (t.width_mm - t.neck_width_mm) * smooth_step(z / contact_mm)) -
         0.3 * above * above;
}

/// Half the depth at a height above the neck: incisors end in an edge.
double half_depth(const ToothForm& t, double z) {
  if (z < 0.0) return 0.5 * t.neck_depth_mm * (1.0 - 0.72 * std::pow(-z / t.root_mm, 1.4));
  const double bulge = is_front(t) ? 0.2 : 0.4;
  const double top_mm = t.cusps.empty() ? 0.75 : is_front(t) ? 1.1 : 0.36 * t.depth_mm;
  const double at = z / t.crown_mm;
  if (at < bulge)
    return 0.5 * (t.neck_depth_mm + (t.depth_mm - t.neck_depth_mm) * smooth_step(at / bulge));
  const double s = std::min((at - bulge) / (1.0 - bulge), 1.2);
  return 0.5 * t.depth_mm + (top_mm - 0.5 * t.depth_mm) * (is_front(t) ? s : s * s);
}

/// Height of the occlusal surface above the neck, and its steepness.
struct Top {
  double height_mm, steepness;
};

Top top_of(const ToothForm& t, double x, double y) {
  if (t.cusps.empty()) return {t.crown_mm, 0.0};
  const double steepness = is_front(t) ? 0.4 : is_molar(t) ? 0.75 : 0.8;
  constexpr double kRound_mm = 0.6;
  double height = -1e9;
  for (const Cusp& cusp : t.cusps) {
    // The tip of a canine is a ridge from labial to lingual.
    const double across = is_front(t) ? 0.0 : y - cusp.buccal_mm;
    const double d =
        std::sqrt(squared_mm2(x - cusp.distal_mm) + squared_mm2(across) + kRound_mm * kRound_mm);
    const double one = t.crown_mm - cusp.below_mm - steepness * (d - kRound_mm);
    height = height < -1e8 ? one : join(height, one, 0.3);
  }
  return {height, steepness};
}

/// Roots of a molar below the furcation; upper ones have two buccal roots and a palatal one.
double molar_roots(const ToothForm& t, const Vec3& p) {
  const double x = 0.27 * t.neck_width_mm, y = 0.24 * t.neck_depth_mm, end = -t.root_mm + 1.1;
  const double top = -kFurcation_mm + 2.0;
  double roots = -1e9;
  for (const double side : {-1.0, 1.0}) {
    if (t.is_upper) {
      roots =
          std::max(roots, cone(p, {side * x, y, top}, {1.3 * side * x, 1.2 * y, end}, 1.7, 1.1));
      continue;
    }
    for (const double across : {-1.0, 1.0})  // One flat root: two cones that overlap.
      roots = std::max(roots, cone(p, {side * x, 0.7 * across * y, top},
                                   {1.15 * side * x, 0.45 * across * y, end}, 1.8, 1.1));
  }
  if (t.is_upper) roots = std::max(roots, cone(p, {0, -y, top}, {0, -1.5 * y, end}, 2.2, 1.3));
  return roots;
}

struct CrownAndRoot {
  double all, root;
};

/// A tooth in its own frame.
CrownAndRoot levels_of(const ToothForm& t, const Vec3& p) {
  const double exponent = is_front(t) ? 2.2 : 2.7;
  const double z = std::clamp(p.z(), -t.root_mm, 1.2 * t.crown_mm);
  const double side = superellipse(p.x(), p.y(), half_width(t, z), half_depth(t, z), exponent);
  const Top top = top_of(t, p.x(), p.y());
  const double above = (top.height_mm - p.z()) / std::hypot(1.0, top.steepness);
  const double body = meet(side, above, 0.9);
  if (!is_molar(t)) {
    const double all = meet(body, p.z() + t.root_mm, 1.5);
    return {all, all};
  }
  // Above the furcation the trunk keeps the section of the neck.
  const double trunk =
      p.z() > 0.0 ? body
                  : superellipse(p.x(), p.y(), 0.5 * t.neck_width_mm, 0.5 * t.neck_depth_mm, 2.7);
  const double all = join(meet(trunk, p.z() + kFurcation_mm, 1.0), molar_roots(t, p), 0.8);
  return {all, all};
}

void add(const ToothForm& t, const Vec3& p_M, ToothLevels& levels) {
  const Vec3 arm = p_M - (t.origin_M + 0.5 * (t.crown_mm - t.root_mm) * t.axes_M.col(2));
  const double reach =
      std::hypot(0.5 * (t.crown_mm + t.root_mm), 0.6 * t.depth_mm) + kToothReach_mm;
  if (arm.squaredNorm() > reach * reach) return;
  const Vec3 p = t.axes_M.transpose() * (p_M - t.origin_M);
  const auto [all, root] = levels_of(t, p);
  levels.tooth = std::max(levels.tooth, all);
  const double thickness = kEnamel_mm * smooth_step((p.z() + 0.3) / (0.5 * t.crown_mm));
  levels.dentin = std::max(levels.dentin, all - thickness);
  levels.socket = std::max(levels.socket, meet(root + kSocketBone_mm, -kCrest_mm - p.z(), 1.0));
}

/// Cusps of a tooth; the first one is (mesio)buccal. Heights typical; heuristic.
std::vector<Cusp> cusps_of(const ToothForm& t) {
  const double w = t.width_mm, y = 0.27 * t.depth_mm;
  switch (t.fdi % 10) {
    case 1:
    case 2:
      return {};
    case 3:
      return {{-0.03 * w, 0.0, 0.0}};
    case 4:
      return {{0, y, 0}, {0, -y, t.is_upper ? 0.8 : 2.0}};
    case 5:
      return {{0, y, 0}, {0, -y, t.is_upper ? 0.3 : 0.9}};
    default:
      break;
  }
  if (t.is_upper)
    return {{-0.25 * w, y, 0}, {0.22 * w, y, 0.3}, {-0.15 * w, -y, 0.1}, {0.28 * w, -y, 0.9}};
  std::vector<Cusp> cusps{
      {-0.27 * w, y, 0}, {0.1 * w, y, 0.2}, {-0.22 * w, -y, 0.2}, {0.2 * w, -y, 0.4}};
  if (t.fdi % 10 == 6) cusps.push_back({0.36 * w, 0.7 * y, 0.6});
  return cusps;
}

/// A point of the ellipse of contacts of one side, by its angle from the middle.
Vec3 on_ellipse(bool is_upper, double side, double angle) {
  const double inside = is_upper ? 0.0 : kInside_mm;
  return {side * (kUpperHalf_mm - inside) * std::sin(angle),
          kCenter_mm - (kUpperDepth_mm - inside) * std::cos(angle), 0.0};
}

/// The angle at which the chord from another one has the given length.
double after_chord(bool is_upper, double angle, double chord_mm) {
  double low = angle, high = angle + 0.7;
  const Vec3 from = on_ellipse(is_upper, 1.0, angle);
  for (int n = 0; n < 50; ++n) {
    const double middle = 0.5 * (low + high);
    ((on_ellipse(is_upper, 1.0, middle) - from).norm() < chord_mm ? low : high) = middle;
  }
  return low;
}

/// Places a tooth between two contacts.
/// \param turn_rad  about the axis of the tooth.
void place(ToothForm& t, const Vec3& mesial, const Vec3& distal, double tip_mm, double tilt_rad,
           double turn_rad) {
  const Vec3 along = (distal - mesial).normalized();
  const double up = t.is_upper ? -1.0 : 1.0;
  const Vec3 middle = 0.5 * (mesial + distal);
  Vec3 buccal = Vec3(along.y(), -along.x(), 0.0);
  if (buccal.dot(middle - Vec3(0.0, kCenter_mm, 0.0)) < 0.0) buccal = -buccal;
  const Vec3 axis = up * std::cos(tilt_rad) * Vec3::UnitZ() + std::sin(tilt_rad) * buccal;
  buccal = (buccal - buccal.dot(axis) * axis).normalized();
  const double c = std::cos(turn_rad), s = std::sin(turn_rad);
  t.axes_M.col(0) = c * along + s * buccal;
  t.axes_M.col(1) = c * buccal - s * along;
  t.axes_M.col(2) = axis;
  const double contact_mm = kContactHeight * t.crown_mm;
  Vec3 contact = middle;
  contact.z() = tip_mm - up * (t.crown_mm - contact_mm) * std::cos(tilt_rad);
  t.origin_M = contact - contact_mm * axis;
}

}  // namespace

Vec3 ToothForm::tip_M() const {
  const Cusp tip = cusps.empty() ? Cusp{} : cusps.front();
  return origin_M + axes_M * Vec3(tip.distal_mm, tip.buccal_mm, crown_mm - tip.below_mm);
}

Dentition::Dentition(std::uint64_t seed) {
  constexpr double kRadians = std::numbers::pi / 180.0;
  constexpr double kTilt_deg = 1.5, kTurn_deg = 3.0, kTip_mm = 0.15, kCusp_mm = 0.15;
  std::mt19937_64 bits(seed);
  const auto draw = [&](double limit) {
    return limit * (2.0 * double(bits() >> 11) * 0x1p-53 - 1.0);
  };
  for (const bool is_upper : {true, false})
    for (const double side : {-1.0, 1.0}) {
      double angle = 0.0;
      std::vector<ToothForm> quadrant;
      for (std::size_t n = 0; n < kUpperSizes.size(); ++n) {
        const ToothSize& size = (is_upper ? kUpperSizes : kLowerSizes)[n];
        ToothForm t;
        t.is_upper = is_upper;
        t.fdi = (is_upper ? (side < 0.0 ? 10 : 20) : (side < 0.0 ? 40 : 30)) + int(n) + 1;
        t.crown_mm = size.crown;
        t.root_mm = size.root;
        t.width_mm = size.width;
        t.neck_width_mm = size.neck_width;
        t.depth_mm = size.depth;
        t.neck_depth_mm = size.neck_depth;
        t.cusps = cusps_of(t);
        for (Cusp& cusp : t.cusps) cusp.below_mm += std::abs(draw(kCusp_mm));
        const double next = after_chord(is_upper, angle, size.width - kContact_mm);
        const double tilt_deg = (is_upper ? kUpperTilt_deg : kLowerTilt_deg)[n] + draw(kTilt_deg);
        const double tip_mm = (is_upper ? kUpperTip_mm : kLowerTip_mm)[n] + draw(kTip_mm);
        place(t, on_ellipse(is_upper, side, angle), on_ellipse(is_upper, side, next), tip_mm,
              kRadians * tilt_deg, kRadians * draw(kTurn_deg));
        angle = next;
        quadrant.push_back(std::move(t));
      }
      if (side < 0.0) std::reverse(quadrant.begin(), quadrant.end());
      teeth_.insert(teeth_.end(), quadrant.begin(), quadrant.end());
    }
}

ToothLevels Dentition::upper(const Vec3& p_M) const {
  ToothLevels levels;
  for (const ToothForm& t : teeth_)
    if (t.is_upper) add(t, p_M, levels);
  return levels;
}

ToothLevels Dentition::lower(const Vec3& p_M) const {
  ToothLevels levels;
  for (const ToothForm& t : teeth_)
    if (!t.is_upper) add(t, p_M, levels);
  constexpr double kNear_mm = 4.0;  // Dentin is below the facets by this or less.
  if (levels.tooth < -kNear_mm) return levels;
  const double facet = -(upper(p_M).tooth + kFacetGap_mm);
  levels.tooth = std::min(levels.tooth, facet);
  levels.dentin = std::min(levels.dentin, facet - 0.6);
  return levels;
}

const ToothForm& Dentition::tooth(int fdi) const {
  const auto found =
      std::find_if(teeth_.begin(), teeth_.end(), [&](const ToothForm& t) { return t.fdi == fdi; });
  LEFORT_CHECK(found != teeth_.end());
  return *found;
}

}  // namespace lefort::anatomy
