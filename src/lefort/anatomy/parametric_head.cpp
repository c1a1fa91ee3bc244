#include <lefort/anatomy/implicit_shapes.h>
#include <lefort/anatomy/parametric_head.h>
#include <lefort/core/parallel.h>

#include <numbers>
#include <random>
#include <utility>

namespace lefort::anatomy {
namespace {

using implicit::cone;
using implicit::ellipsoid;
using implicit::join;
using implicit::rounded_box;
using implicit::tube;
using implicit::without;

constexpr double kStomion_mm = -49.0;  // Height of the line between the lips, mean head.
const Vec3 kHinge(0.0, -20.5, -6.5);
const Vec3 kLowerArch(0.0, -65.0, -55.0);  // The middle of the lower arch.

/// The right half of the head as a mirror image: |x|.
Vec3 folded(const Vec3& p) { return {std::abs(p.x()), p.y(), p.z()}; }

/// Without the deviation of the chin, which grows from the level of the mouth down.
Vec3 straightened(const Vec3& p, const HeadShape& shape) {
  const double t = std::clamp((-38.0 - p.z()) / 40.0, 0.0, 1.0);
  return {p.x() - shape.chin_mm.x() * t * t * (3.0 - 2.0 * t), p.y(), p.z()};
}

/// Rotation of the mandible about the axis of its condyles; positive opens the mouth.
Vec3 about_condyles(const Vec3& p, double angle_rad) {
  return kHinge + Eigen::AngleAxisd(angle_rad, Vec3::UnitX()) * (p - kHinge);
}

/// A rotation about a point.
RigidTransform about(const Vec3& point, const Vec3& rotation_rad) {
  RigidTransform X = RigidTransform::Identity();
  if (const double angle = rotation_rad.norm(); angle > 0.0)
    X.linear() = Eigen::AngleAxisd(angle, rotation_rad / angle).toRotationMatrix();
  X.translation() = point - X.linear() * point;
  return X;
}

/// The part of HeadShape::jaw_offset_mm by which the mandible moves at a place in the mean head: 0
/// in the ramus, 1 in the body.
double part_of_body(double y_mm) {
  constexpr double kRamus_mm = -22.0, kBody_mm = -44.0;
  const double t = std::clamp((y_mm - kRamus_mm) / (kBody_mm - kRamus_mm), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

Vec3 in_plane(const Vec3& v) { return {0.0, v.y(), v.z()}; }

double cranium(const Vec3& p, const HeadShape& s) {
  const double floor = p.z() + 12.0;
  const double outer = std::min(ellipsoid(p, {0, -8, 46}, {71, 88, 72}), floor);
  const double inner = std::min(ellipsoid(p, {0, -8, 46}, {64, 81, 65}), floor - 7.0);
  const double glabella = ellipsoid(p, Vec3(0, -92, 42) + in_plane(s.nasion_mm), {14, 6, 9});
  double bone = join(std::min(outer, -inner), glabella, 6.0);
  const Vec3 q = folded(p);
  bone = join(bone, ellipsoid(q, {52, 8, -8}, {12, 16, 14}), 5.0);  // Temporal bone.
  return without(bone, cone(q, {85, 0, -4}, {40, 0, -4}, 4.0, 3.0), 1.0);
}

double zygoma(const Vec3& q, const HeadShape& s) {
  const double arch = s.zygion_mm;
  const double body = ellipsoid(q, {46, -67, -9}, {11, 11, 11});
  const double bow = tube(q,
                          {{48, -66, -8},
                           {62 + 0.8 * arch, -50, -4},
                           {66 + arch, -35, -3},
                           {63 + 0.8 * arch, -20, -1},
                           {55, -4, 2}},
                          3.5);
  return join(body, bow, 5.0);
}

/// Rims of the orbits and nasal bones.
double rims(const Vec3& p, const HeadShape& s) {
  const Vec3 q = folded(p);
  const Vec3 up(0, 0, s.orbit_mm), down(0, 0, -s.orbit_mm);
  const double lower =
      tube(q, {Vec3(19, -83, 6) + down, Vec3(33, -75, -3) + down, Vec3(46, -68, 4) + down}, 3.0);
  const double lateral =
      tube(q, {Vec3(46, -68, 4) + down, {49, -69, 16}, Vec3(47, -72, 29) + up}, 4.0);
  const double upper =
      tube(q, {Vec3(47, -72, 29) + up, Vec3(33, -87, 36) + up, Vec3(14, -92, 34) + up}, 4.0);
  const Vec3 root = Vec3(0, -90, 28) + in_plane(s.nasion_mm);
  const double nasal = cone(q, root, Vec3(0, -104, 9) + 0.5 * in_plane(s.nose_mm), 4.0, 3.0);
  return join(join(join(lower, lateral, 2.0), upper, 2.0), nasal, 4.0);
}

double maxilla(const Vec3& p, const HeadShape& s) {
  const Vec3 q = folded(p);
  const Vec3 spine = in_plane(s.anterior_spine_mm), teeth = in_plane(s.upper_incisors_mm);
  double bone =
      std::min(ellipsoid(q, Vec3(0, -50, -14) + 0.5 * spine, {43, 41, 29}), -48.0 - p.y());
  bone = join(bone, zygoma(q, s), 6.0);
  bone = without(bone, ellipsoid(q, {24, -60, -11}, {9, 13, 11}), 1.0);  // Sinus.
  const Vec3 alveolus = 0.5 * (spine + teeth);
  const double ridge = tube(
      q,
      {Vec3(0, -89, -38) + alveolus, Vec3(14, -85, -38) + alveolus, {24, -70, -38}, {27, -52, -37}},
      5.0);
  const double front = cone(q, Vec3(0, -82, -28) + spine, Vec3(0, -85.5, -38) + alveolus, 5.0, 6.0);
  bone = join(join(bone, ridge, 5.0), front, 4.0);
  const double mouth = ellipsoid(q, {0, -60, -42}, {17, 24, 14});
  return without(bone, mouth, 3.0);
}

double palate(const Vec3& p, const HeadShape& s) {
  const double back = -48.0 + s.palate_mm;
  const Vec3 spine = in_plane(s.anterior_spine_mm);
  const double front = -86.0 + spine.y(), z = -26.5 + spine.z();
  const double plate =
      rounded_box(p, {0, 0.5 * (front + back), z}, {15, 0.5 * (back - front), 2.2}, 1.5);
  const double posterior = cone(p, {0, back - 6.0, z}, {0, back + 2.0, z}, 2.2, 1.6);
  const double anterior = cone(p, Vec3(0, -84, -26) + spine, Vec3(0, -93, -24) + spine, 3.0, 1.5);
  // The vomer: its posterior border rises from the palate to the skull base.
  const double border = (back - 3.0 + 0.7 * (p.z() - z)) - p.y();
  const double vomer =
      std::min({1.2 - std::abs(p.x()), border, p.y() + 82.0 - spine.y(), p.z() - z, -8.0 - p.z()});
  return join(join(join(plate, posterior, 1.5), anterior, 2.0), vomer, 1.0);
}

double ridge_of_upper_teeth(const Vec3& p, const HeadShape& s) {
  const Vec3 q = folded(p), teeth = in_plane(s.upper_incisors_mm);
  const double incisors = ellipsoid(q, Vec3(0, -95, -44.5) + teeth, {9, 3.5, 7.5});
  const double arch = tube(
      q, {Vec3(0, -93, -45) + teeth, Vec3(15, -87, -45) + teeth, {25, -70, -45}, {28, -52, -44}},
      4.0);
  const double cusp = cone(q, {28.5, -67, -44}, {28.5, -67, -49}, 4.0, 2.6);
  return join(join(incisors, arch, 3.0), cusp, 1.5);
}

/// The head of the condyle: medial and lateral end of its axis.
const std::pair<Vec3, Vec3> kCondyle{{45, -21, -7}, {54, -20, -6}};
constexpr double kCondyleRadius_mm = 5.0;

/// Lower border and alveolar process of the body, and the ramus.
double lower_jaw(const Vec3& p, const HeadShape& s) {
  const Vec3 q = folded(p), chin = in_plane(s.chin_mm), angle = s.gonion_mm;
  const double border =
      tube(q,
           {Vec3(0, -81, -87) + chin, Vec3(19, -75, -86) + chin,
            Vec3(37, -48, -76) + 0.5 * angle + 0.4 * chin, Vec3(46, -20, -62) + angle},
           6.5);
  const double alveolus =
      tube(q, {{0, -84, -64}, {16, -78, -64}, {26, -60, -63}, {34, -40, -60}}, 5.0);
  const double middle = tube(q,
                             {Vec3(0, -80, -75) + 0.6 * chin,
                              Vec3(18, -75, -75) + 0.6 * chin,
                              {32, -52, -70},
                              {42, -28, -60}},
                             7.0);
  const double behind = tube(q, {Vec3(46, -20, -62) + angle, {50, -19, -14}}, 5.0);
  const double ahead = tube(q, {{42, -38, -62}, {44, -40, -30}, {45, -40, -12}}, 3.5);
  const double between = tube(q, {{45, -28, -60}, {47, -27, -26}}, 4.0);
  const double condyle = tube(q, {kCondyle.first, kCondyle.second}, kCondyleRadius_mm);
  const double point = ellipsoid(q, Vec3(0, -83, -88) + chin, {12, 8, 8});
  const double body = join(join(border, middle, 6.0), alveolus, 6.0);
  const double ramus = join(join(behind, ahead, 5.0), between, 6.0);
  return join(join(join(body, ramus, 6.0), condyle, 4.0), point, 5.0);
}

double ridge_of_lower_teeth(const Vec3& p) {
  const Vec3 q = folded(p);
  const double incisors = ellipsoid(q, {0, -87, -57}, {8, 3, 8.5});
  const double arch = tube(q, {{0, -86, -58}, {15, -80, -58}, {25, -62, -58}, {30, -46, -56}}, 4.0);
  const double cusp = cone(q, {27.5, -63, -58}, {27.5, -63, -54}, 4.0, 2.6);
  return join(join(incisors, arch, 3.0), cusp, 1.5);
}

double nose(const Vec3& p, const HeadShape& s) {
  const Vec3 q = folded(p), tip = in_plane(s.nose_mm);
  const Vec3 root = Vec3(0, -97, 30) + in_plane(s.nasion_mm);
  const double bridge = cone(q, root, Vec3(0, -117, -2) + tip, 6.0, 8.0);
  const double lobule = ellipsoid(q, Vec3(0, -117, -8) + tip, {10, 11, 9});
  const double inner = cone(q, {0, -86, 22}, {0, -98, -8}, 9.0, 12.0);
  const double ala = ellipsoid(q, Vec3(12, -108, -12) + 0.6 * tip, {7, 9, 8});
  return join(join(join(bridge, inner, 8.0), lobule, 5.0), ala, 3.0);
}

/// Upper and lower lip rest on the upper incisors: stomion is 3 mm above their edge, the middle of
/// the normal incisal display of 2 to 4 mm \cite arnett1993.
/// \param jaw  the point as the mandible is given: not opened.
double mouth(const Vec3& p, const Vec3& jaw, double body, const HeadShape& s) {
  const Vec3 q = folded(p), lips = in_plane(s.upper_incisors_mm) - Vec3(0, s.lips_mm, 0);
  const Vec3 chin = in_plane(s.chin_mm);
  body = join(body, ellipsoid(q, Vec3(0, -100, -41.5) + lips, {19, 9, 8}), 4.0);
  body = join(body, ellipsoid(q, Vec3(0, -98, -55.5) + lips, {18, 9, 7}), 4.0);
  body = join(body, ellipsoid(folded(jaw), Vec3(0, -84, -89) + chin, {18, 16, 13}), 10.0);
  const double slit = std::min(0.8 - std::abs(p.z() - kStomion_mm - lips.z()),
                               std::min(23.0 - q.x(), -101.5 + lips.y() - p.y()));
  return without(body, slit, 1.0);
}

}  // namespace

ParametricHead::ParametricHead(const HeadShape& shape) : shape_(shape) {
  X_LH_ = RigidTransform::Identity();
  X_LH_.translation() = shape.translation_mm;
  if (const double angle = shape.rotation_rad.norm(); angle > 0.0)
    X_LH_.linear() = Eigen::AngleAxisd(angle, shape.rotation_rad / angle).toRotationMatrix();
  X_HL_ = X_LH_.inverse();
  X_body_H_ = X_opening_H_ = X_jaw_H_ = RigidTransform::Identity();
  if (shape.dentition == 0) return;
  teeth_ = std::make_shared<Dentition>(shape.dentition);
  X_opening_H_ = about(from_mean(kHinge), {shape.opening_rad, 0.0, 0.0});
  X_body_H_ = Eigen::Translation3d(shape.jaw_offset_mm) *
              about(from_mean(kLowerArch), shape.jaw_rotation_rad);
  X_jaw_H_ = X_opening_H_ * X_body_H_;
}

Vec3 ParametricHead::in_jaw(const Vec3& p_H) const {
  if (!teeth_)
    return straightened(about_condyles(p_H.cwiseQuotient(shape_.scale), -shape_.opening_rad),
                        shape_);
  const Vec3 q_H = X_opening_H_.inverse() * p_H;
  const double part = part_of_body(q_H.y() / shape_.scale.y());
  const Vec3 moved_H = q_H + part * (X_body_H_.inverse() * q_H - q_H);
  return straightened(moved_H.cwiseQuotient(shape_.scale), shape_);
}

Vec3 ParametricHead::in_dentition(const Vec3& p_H) const {
  return p_H.cwiseQuotient(shape_.scale) - in_plane(shape_.upper_incisors_mm);
}

Vec3 ParametricHead::from_tooth_L(const ToothForm& tooth, const Vec3& p_M) const {
  const Vec3 closed_H = from_mean(p_M + in_plane(shape_.upper_incisors_mm));
  return X_LH_ * (tooth.is_upper ? closed_H : Vec3(X_jaw_H_ * closed_H));
}

double ParametricHead::skin(const Vec3& p_L) const {
  const HeadShape& s = shape_;
  const Vec3 bent = (X_HL_ * p_L).cwiseQuotient(s.scale);
  const Vec3 p = straightened(bent, s), q = folded(p);
  const Vec3 jaw = in_jaw(X_HL_ * p_L);
  const double head = ellipsoid(p, {0, -8, 46}, {78, 96, 80});
  const double face = ellipsoid(p, {0, -40, -30}, {68, 62, 72});
  const double neck =
      std::min(ellipsoid({p.x(), p.y(), 0.0}, {0, 5, 0}, {56, 60, 1.0}), -40.0 - p.z());
  double body = join(join(head, face, 20.0), neck, 15.0);
  body = join(body, ellipsoid(q, {80, 6, -2}, {5, 14, 28}), 4.0);     // Ear.
  body = join(body, ellipsoid(q, {32, -80, 15}, {14, 13, 11}), 3.0);  // Eye.
  body = join(body, nose(p, s), 6.0);
  // Min depth of soft tissue over the mandible and the zygoma; heuristic.
  constexpr double kOverMandible_mm = 5.0, kOverZygoma_mm = 4.0;
  body = join(body, lower_jaw(jaw, s) + kOverMandible_mm, 4.0);
  body = join(body, zygoma(q, s) + kOverZygoma_mm, 4.0);
  body = mouth(p, jaw, body, s);
  body = without(body, ellipsoid(q, {16, -96, 14}, {3, 6, 3}), 2.0);    // Medial canthus.
  return without(body, ellipsoid(q, {46.5, -86, 14}, {3, 8, 3}), 2.0);  // Lateral canthus.
}

double ParametricHead::skull(const Vec3& p_L) const {
  const double bone = skull_bone(p_L);
  if (teeth_) return std::max(bone, upper_teeth(p_L).tooth);
  return join(bone, ridge_of_upper_teeth((X_HL_ * p_L).cwiseQuotient(shape_.scale), shape_), 2.0);
}

double ParametricHead::skull_bone(const Vec3& p_L) const {
  const HeadShape& s = shape_;
  const Vec3 p = (X_HL_ * p_L).cwiseQuotient(s.scale), q = folded(p);
  double bone = join(cranium(p, s), alveolar(maxilla(p, s), p_L), 5.0);
  const double orbit = ellipsoid(q, {33, -70, 16}, {18, 44, 18 + s.orbit_mm});
  bone = join(without(bone, orbit, 2.0), rims(p, s), 3.0);
  const Vec3 spine = in_plane(s.anterior_spine_mm);
  bone = without(bone, ellipsoid(q, Vec3(0, -75, -7) + 0.5 * spine, {12, 40, 19}),
                 2.0);  // Nasal cavity.
  bone = join(bone, palate(p, s), 1.5);
  // The mandibular fossa: a joint space of 2 mm around the head of the condyle.
  bone = without(bone, tube(q, {kCondyle.first, kCondyle.second}, kCondyleRadius_mm + 2.0), 1.0);
  const double pterygoid = tube(q, {{14, -42, -10}, {16, -41, -32}}, 3.0);
  return join(bone, pterygoid, 2.0);
}

double ParametricHead::alveolar(double maxilla, const Vec3& p_L) const {
  if (!teeth_) return maxilla;
  constexpr double kCrest_mm = -41.8;  // Heuristic: above the necks of the teeth.
  const double height_mm = in_dentition(X_HL_ * p_L).z() - kCrest_mm;
  return join(-join(-maxilla, -height_mm, 2.0), upper_teeth(p_L).socket, 3.0);
}

double ParametricHead::mandible(const Vec3& p_L) const {
  const double bone = mandible_bone(p_L);
  if (teeth_) return std::max(bone, lower_teeth(p_L).tooth);
  return join(bone, ridge_of_lower_teeth(in_jaw(X_HL_ * p_L)), 2.0);
}

double ParametricHead::mandible_bone(const Vec3& p_L) const {
  const double bone = lower_jaw(in_jaw(X_HL_ * p_L), shape_);
  return teeth_ ? join(bone, lower_teeth(p_L).socket, 3.0) : bone;
}

ToothLevels ParametricHead::upper_teeth(const Vec3& p_L) const {
  return teeth_->upper(in_dentition(X_HL_ * p_L));
}

ToothLevels ParametricHead::lower_teeth(const Vec3& p_L) const {
  return teeth_->lower(in_dentition(X_jaw_H_.inverse() * (X_HL_ * p_L)));
}

double ParametricHead::pharynx(const Vec3& p_L) const {
  constexpr double kRadius_mm = 8.0, kTop_mm = -15.0;
  const Vec3 p = (X_HL_ * p_L).cwiseQuotient(shape_.scale);
  return std::min(kRadius_mm - std::hypot(p.x(), p.y() + 20.0), kTop_mm - p.z());
}

Vec3 ParametricHead::opened(const Vec3& mean) const {
  if (!teeth_) return about_condyles(mean, shape_.opening_rad);
  const Vec3 p_H = from_mean(mean);
  const Vec3 moved_H = p_H + part_of_body(mean.y()) * (X_body_H_ * p_H - p_H);
  return (X_opening_H_ * moved_H).cwiseQuotient(shape_.scale);
}

HeadShape draw_head_shape(std::uint64_t seed) {
  std::mt19937_64 bits(seed);
  const auto draw = [&](double limit) {
    return limit * (2.0 * double(bits() >> 11) * 0x1p-53 - 1.0);
  };
  const auto vector = [&](double x, double y, double z) {
    const double a = draw(x), b = draw(y), c = draw(z);  // In this order.
    return Vec3(a, b, c);
  };
  constexpr double kTurn_rad = 10.0 * std::numbers::pi / 180.0;
  HeadShape s;
  s.scale = Vec3::Ones() + vector(0.07, 0.07, 0.07);
  s.nasion_mm = vector(0, 2, 3);
  s.anterior_spine_mm = vector(0, 3, 2);
  s.upper_incisors_mm = vector(0, 3, 1);
  s.chin_mm = vector(2.5, 6, 4);
  s.gonion_mm = vector(3, 4, 4);
  s.nose_mm = vector(0, 4, 4);
  s.zygion_mm = draw(4.0);
  s.orbit_mm = draw(1.5);
  s.lips_mm = draw(2.5);
  s.palate_mm = draw(3.0);
  s.rotation_rad = vector(kTurn_rad, kTurn_rad, kTurn_rad);
  s.translation_mm = vector(15, 15, 15);
  return s;
}

}  // namespace lefort::anatomy
