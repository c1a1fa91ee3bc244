#include <lefort/anatomy/parametric_head.h>

#include <functional>
#include <map>
#include <optional>

namespace lefort::anatomy {
namespace {

const Vec3 kStomion(0.0, -125.0, -49.0);  // Anterior to it, mean head.

using Level = std::function<double(const Vec3&)>;

Vec3 gradient(const Level& level, const Vec3& p) {
  constexpr double kStep_mm = 1e-3;
  Vec3 g;
  for (Index axis = 0; axis < 3; ++axis) {
    const Vec3 h = kStep_mm * Vec3::Unit(axis);
    g[axis] = (level(p + h) - level(p - h)) / (2.0 * kStep_mm);
  }
  return g;
}

/// Climbs on the zero surface of a level-set function.
class Climber {
 public:
  /// \param fixed  unit vector: points move in the plane normal to it; zero: freely.
  Climber(const Level& level, const Vec3& fixed) : level_(level), fixed_(fixed) {}

  /// The closest surface point, nearly, by Newton's method.
  [[nodiscard]] Vec3 onto(Vec3 p) const {
    constexpr int kIterations = 60;
    constexpr double kMaxStep_mm = 1.0, kTolerance_mm = 1e-7;
    for (int n = 0; n < kIterations; ++n) {
      const double value = level_(p);
      if (std::abs(value) < kTolerance_mm) break;
      const Vec3 g = free(gradient(level_, p));
      const double length_mm = std::min(std::abs(value) / std::max(g.norm(), 0.2), kMaxStep_mm);
      p -= (value > 0.0 ? length_mm : -length_mm) * g.normalized();
    }
    return p;
  }

  /// The local maximum of a direction on the surface.
  [[nodiscard]] Vec3 climb(const Vec3& start, const Vec3& direction) const {
    constexpr double kFirst_mm = 0.5, kLast_mm = 1e-4;
    constexpr int kMaxSteps = 2000;
    Vec3 p = onto(start);
    double step_mm = kFirst_mm;
    for (int n = 0; n < kMaxSteps && step_mm > kLast_mm; ++n) {
      const Vec3 normal = free(gradient(level_, p)).normalized();
      const Vec3 along = free(direction) - normal.dot(free(direction)) * normal;
      const Vec3 next = onto(p + step_mm * along.normalized());
      if (along.norm() > 1e-9 && direction.dot(next) > direction.dot(p) + 1e-9)
        p = next;
      else
        step_mm *= 0.5;
    }
    return p;
  }

 private:
  [[nodiscard]] Vec3 free(const Vec3& v) const { return v - fixed_.dot(v) * fixed_; }
  const Level& level_;
  Vec3 fixed_;
};

/// The rules, in the natural directions of the head.
class TrueLandmarks {
 public:
  explicit TrueLandmarks(const ParametricHead& head)
      : head_(head),
        skin_([&head](const Vec3& p) { return head.skin(p); }),
        skull_([&head](const Vec3& p) { return head.skull(p); }),
        mandible_([&head](const Vec3& p) { return head.mandible(p); }),
        R_LF_(head.X_LH().linear()) {}

  std::vector<NamedPoint> find() {
    find_ears_and_orbits();
    turn_to_frankfurt();
    find_ears_and_orbits();
    find_midface();
    find_mandible();
    find_nose();
    find_mouth();
    std::vector<NamedPoint> all;
    for (const auto& [name, p_L] : at_) all.push_back({name, p_L});
    return all;
  }

 private:
  /// A point of the mean head, moved by its parameter, in L.
  [[nodiscard]] Vec3 place(const Vec3& mean, const Vec3& offset = Vec3::Zero()) const {
    return head_.X_LH() * head_.from_mean(mean + Vec3(0.0, offset.y(), offset.z()));
  }
  /// A point of the lips of the mean head, moved by their parameters.
  [[nodiscard]] Vec3 lips(const Vec3& mean) const {
    const HeadShape& s = head_.shape();
    return mean + Vec3(0.0, s.upper_incisors_mm.y() - s.lips_mm, s.upper_incisors_mm.z());
  }
  /// A point of the mandible of the mean head, in L.
  [[nodiscard]] Vec3 place_opened(const Vec3& mean) const {
    return head_.X_LH() * head_.from_mean(head_.opened(mean));
  }
  [[nodiscard]] Vec3 direction(const Vec3& v_F) const { return (R_LF_ * v_F).normalized(); }
  [[nodiscard]] Vec3 left() const { return R_LF_.col(0); }
  [[nodiscard]] Vec3 climb(const Level& level, const Vec3& start_L, const Vec3& v_F) const {
    return Climber(level, Vec3::Zero()).climb(start_L, direction(v_F));
  }
  [[nodiscard]] Vec3 climb_in_section(const Level& level, const Vec3& start_L,
                                      const Vec3& v_F) const {
    return Climber(level, left()).climb(start_L, direction(v_F));
  }
  /// The point of a sagittal section furthest from the chord between two points, to posterior.
  [[nodiscard]] Vec3 deepest(const Level& level, const Vec3& start_L, const Vec3& one_L,
                             const Vec3& two_L) const {
    const Vec3 chord = R_LF_.transpose() * (two_L - one_L);
    Vec3 normal(0.0, chord.z(), -chord.y());
    if (normal.y() < 0.0) normal = -normal;
    return climb_in_section(level, start_L, normal);
  }
  /// The first point of the body on the line from `start_L` along a direction.
  [[nodiscard]] Vec3 march(const Level& level, Vec3 start_L, const Vec3& direction_L) const {
    constexpr double kStep_mm = 0.02, kMax_mm = 80.0;
    for (double s = 0.0; s < kMax_mm && level(start_L) <= 0.0; s += kStep_mm)
      start_L += kStep_mm * direction_L;
    return start_L;
  }

  /// With teeth: the middle of the points of both central incisors that are the furthest in a
  /// direction, each in the sagittal section through its tip.
  [[nodiscard]] Vec3 of_incisors(const Level& level, int right, int left, const Vec3& v_F) const {
    Vec3 middle_L = Vec3::Zero();
    for (const int fdi : {right, left}) {
      const ToothForm& tooth = head_.dentition().tooth(fdi);
      middle_L += 0.5 * climb_in_section(level, head_.from_tooth_L(tooth, tooth.tip_M()), v_F);
    }
    return middle_L;
  }
  /// With teeth: the mesiobuccal cusp of a molar.
  [[nodiscard]] Vec3 of_molar(const Level& level, int fdi, const Vec3& v_F) const {
    const ToothForm& tooth = head_.dentition().tooth(fdi);
    return climb(level, head_.from_tooth_L(tooth, tooth.tip_M()), v_F);
  }

  void find_ears_and_orbits() {
    constexpr double kHalf_mm = 9.0, kStep_mm = 0.25;
    const HeadShape& s = head_.shape();
    for (const double sign : {-1.0, 1.0}) {
      const std::string side = sign > 0.0 ? "-L" : "-R";
      at_["Po" + side] =
          march(skull_, place({sign * 85.0, 0.0, 0.2}), head_.X_LH().linear() * Vec3(-sign, 0, 0));
      std::optional<Vec3> lowest;
      for (int n = 0; n <= int(2.0 * kHalf_mm / kStep_mm); ++n) {
        const double x = 33.0 - kHalf_mm + kStep_mm * n;
        const Vec3 p =
            climb_in_section(skull_, place({sign * x, -77.0, -1.0 - s.orbit_mm}), {0, -1, 1});
        if (!lowest || R_LF_.col(2).dot(p) < R_LF_.col(2).dot(*lowest)) lowest = p;
      }
      at_["Or" + side] = *lowest;
    }
  }

  void turn_to_frankfurt() {
    const Vec3 ahead = at_.at("Or-R") + at_.at("Or-L") - at_.at("Po-R") - at_.at("Po-L");
    const Vec3 posterior = -(ahead - left().dot(ahead) * left()).normalized();
    R_LF_.col(1) = posterior;
    R_LF_.col(2) = left().cross(posterior);
  }

  void find_midface() {
    const HeadShape& s = head_.shape();
    const Vec3 anterior(0, -1, 0);
    const Vec3 posterior(0, 1, 0);
    at_["N"] = climb_in_section(skull_, place({0, -93, 30}, s.nasion_mm), posterior);
    at_["ANS"] =
        climb_in_section(skull_, place({0, -94, -24}, s.anterior_spine_mm), {0, -0.94, 0.34});
    at_["PNS"] = place({0, -44.4 + s.palate_mm, -26.5 + s.anterior_spine_mm.z()});
    const bool teeth = head_.has_dentition();
    const Vec3 crest =
        teeth ? of_incisors(skull_, 11, 21, anterior)
              : climb_in_section(skull_, place({0, -98, -44.5}, s.upper_incisors_mm), anterior);
    const Vec3 ridge = 0.5 * (s.anterior_spine_mm + s.upper_incisors_mm);
    at_["A"] = deepest(skull_, place({0, -89.5, -32}, ridge), at_.at("ANS"), crest);
    at_["U1"] =
        teeth ? of_incisors(skull_, 11, 21, {0, 0, -1})
              : climb_in_section(skull_, place({0, -95, -52}, s.upper_incisors_mm), {0, 0, -1});
    for (const double sign : {-1.0, 1.0}) {
      const std::string side = sign > 0.0 ? "-L" : "-R";
      at_["Zy" + side] =
          climb(skull_, place({sign * (69.0 + s.zygion_mm), -35.0, -3.0}), {sign, 0, 0});
      const Vec3 cusp(0.35 * sign, 0, -0.94);
      at_["U6" + side] = teeth ? of_molar(skull_, sign > 0.0 ? 26 : 16, cusp)
                               : climb(skull_, place({sign * 28.5, -67.0, -51.0}), cusp);
    }
  }

  void find_mandible() {
    const HeadShape& s = head_.shape();
    const auto chin = [&](const Vec3& mean, double part = 1.0) {
      return place_opened(mean + part * s.chin_mm);
    };
    at_["Pg"] = climb_in_section(mandible_, chin({0, -91, -88}), {0, -1, 0});
    at_["Me"] = climb_in_section(mandible_, chin({0, -82, -95}), {0, 0, -1});
    at_["Gn"] = climb_in_section(mandible_, chin({0, -88, -93}), {0, -1, -1});
    const bool teeth = head_.has_dentition();
    const Vec3 crest = teeth ? of_incisors(mandible_, 41, 31, {0, -1, 0})
                             : climb_in_section(mandible_, place_opened({0, -90, -57}), {0, -1, 0});
    at_["B"] = deepest(mandible_, chin({0, -86, -72}, 0.6), at_.at("Pg"), crest);
    at_["L1"] = teeth ? of_incisors(mandible_, 41, 31, {0, 0, 1})
                      : climb_in_section(mandible_, place_opened({0, -87, -49}), {0, 0, 1});
    for (const double sign : {-1.0, 1.0}) {
      const std::string side = sign > 0.0 ? "-L" : "-R";
      const Vec3 cusp(0.35 * sign, 0, 0.94);
      at_["L6" + side] = teeth ? of_molar(mandible_, sign > 0.0 ? 36 : 46, cusp)
                               : climb(mandible_, place_opened({sign * 27.5, -63.0, -52.0}), cusp);
      at_["Co" + side] = climb(mandible_, place_opened({sign * 50.0, -20.5, -1.0}), {0, 0, 1});
      at_["Cdl" + side] = climb(mandible_, place_opened({sign * 59.5, -20.0, -6.0}), {sign, 0, 0});
      at_["Cdm" + side] = climb(mandible_, place_opened({sign * 40.0, -21.0, -7.0}), {-sign, 0, 0});
      const Vec3 angle(sign * (50.0 + s.gonion_mm.x()), -15.0 + s.gonion_mm.y(),
                       -66.0 + s.gonion_mm.z());
      at_["Go" + side] = gonion(place_opened(angle), at_.at("Co" + side));
    }
  }

  [[nodiscard]] Vec3 gonion(const Vec3& start_L, const Vec3& condyle_L) const {
    Vec3 p = climb(mandible_, start_L, {0, 1, -1});
    for (int n = 0; n < 4; ++n) {
      const Vec3 ramus = R_LF_.transpose() * (condyle_L - p);
      const Vec3 body = R_LF_.transpose() * (at_.at("Me") - p);
      const Vec3 behind = Vec3(0.0, ramus.z(), -ramus.y()).normalized();
      p = climb(mandible_, p, behind + Vec3(0.0, -body.z(), body.y()).normalized());
    }
    return p;
  }

  void find_nose() {
    const HeadShape& s = head_.shape();
    at_["Prn"] = climb(skin_, place({0, -128, -8}, s.nose_mm), {0, -1, 0});
    at_["N'"] = climb_in_section(skin_, place({0, -103, 32}, s.nasion_mm), {0, 1, 0});
    const Vec3 lip = climb_in_section(skin_, place(lips({0, -109, -40.5})), {0, -1, 0});
    at_["Sn"] = deepest(skin_, place({0, -106, -21}), at_.at("Prn"), lip);
    const Vec3 inwards = head_.X_LH().linear() * Vec3(0, 1, 0);
    for (const double sign : {-1.0, 1.0}) {
      const std::string side = sign > 0.0 ? "-L" : "-R";
      at_["Al" + side] = place({sign * 19.0, -108.0, -12.0}, 0.6 * s.nose_mm);
      at_["En" + side] = march(skin_, place({sign * 16.0, -125.0, 14.0}), inwards);
      at_["Ex" + side] = march(skin_, place({sign * 46.5, -125.0, 14.0}), inwards);
      at_["Ch" + side] = commissure(sign, inwards);
    }
  }

  /// The end of the slit between the lips: the last point on its line that is deeper than the skin
  /// above and below.
  [[nodiscard]] Vec3 commissure(double sign, const Vec3& inwards) const {
    constexpr double kFrom_mm = 8.0, kTo_mm = 32.0, kStep_mm = 0.25, kSide_mm = 3.0;
    constexpr double kMinNotch_mm = 0.2;
    const auto skin_at = [&](double x, double z) {
      return march(skin_, place({sign * x, -125.0, z}), inwards);
    };
    const double line_mm = lips(kStomion).z();
    Vec3 end = skin_at(kFrom_mm, line_mm);
    for (int n = 0; n <= int((kTo_mm - kFrom_mm) / kStep_mm); ++n) {
      const double x = kFrom_mm + kStep_mm * n;
      const Vec3 p = skin_at(x, line_mm);
      const double above_mm = inwards.dot(p - skin_at(x, line_mm + kSide_mm));
      const double below_mm = inwards.dot(p - skin_at(x, line_mm - kSide_mm));
      if (std::min(above_mm, below_mm) < kMinNotch_mm) break;
      end = p;
    }
    return end;
  }

  void find_mouth() {
    const HeadShape& s = head_.shape();
    const Vec3 inwards = head_.X_LH().linear() * Vec3(0, 1, 0);
    at_["Stm"] = march(skin_, place(lips(kStomion)), inwards);
    at_["Ls"] = climb_in_section(skin_, place(lips({0, -109, -41.5})), {0, -1, 0});
    at_["Li"] = climb_in_section(skin_, place(lips({0, -107, -55.5})), {0, -1, 0});
    at_["A'"] = deepest(skin_, place(lips({0, -105, -30})), at_.at("Ls"), at_.at("Sn"));
    at_["Pg'"] = climb_in_section(
        skin_, place_opened({0, -100 + s.chin_mm.y(), -89 + s.chin_mm.z()}), {0, -1, 0});
    at_["B'"] = deepest(skin_, place(lips({0, -96, -68})), at_.at("Li"), at_.at("Pg'"));
    at_["Me'"] = march(skin_, at_.at("Me") - 30.0 * R_LF_.col(2), R_LF_.col(2));
  }

  const ParametricHead& head_;
  Level skin_, skull_, mandible_;
  Mat3 R_LF_;
  std::map<std::string, Vec3> at_;
};

}  // namespace

std::vector<NamedPoint> true_landmarks(const ParametricHead& head) {
  return TrueLandmarks(head).find();
}

}  // namespace lefort::anatomy
