#include <lefort/core/units.h>
#include <lefort/plan/cephalometrics.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string_view>

namespace lefort::plan {
namespace {

/// Lateral projection of the landmarks, seen from the patient's right: x is anterior, y superior.
class Profile {
 public:
  using Point = Eigen::Vector2d;

  /// \param frame  landmarks that define the Frankfurt horizontal.
  Profile(std::span<const Landmark> landmarks, std::span<const Landmark> frame, const Vec3& left)
      : landmarks_(landmarks), frame_(frame), left_(left) {
    anterior_ = left_.cross(Vec3::UnitZ()).normalized();
    up_ = anterior_.cross(left_);
  }
  [[nodiscard]] bool has(const std::string& name) const {
    return pair_midpoint(landmarks_, name).has_value();
  }
  [[nodiscard]] bool has_horizontal() const {
    return pair_midpoint(frame_, "Or") && pair_midpoint(frame_, "Po");
  }
  [[nodiscard]] Point operator()(const std::string& name) const {
    return projected(*pair_midpoint(landmarks_, name));
  }
  /// From porion to orbitale, unit length; not finite if they coincide.
  [[nodiscard]] Point horizontal() const {
    return unit(projected(*pair_midpoint(frame_, "Or")) - projected(*pair_midpoint(frame_, "Po")));
  }
  [[nodiscard]] double width(const std::string& name) const {
    return (*find_landmark(landmarks_, name + "-L") - *find_landmark(landmarks_, name + "-R"))
        .norm();
  }
  [[nodiscard]] bool has_both(const std::string& name) const {
    return find_landmark(landmarks_, name + "-R") && find_landmark(landmarks_, name + "-L");
  }
  /// \returns the unit vector; not finite if the length is below the round-off of coordinates.
  [[nodiscard]] static Point unit(const Point& v) {
    constexpr double kMinLength_mm = 1e-9;
    if (!(v.norm() > kMinLength_mm)) return Point::Constant(std::nan(""));
    return v / v.norm();
  }

 private:
  [[nodiscard]] Point projected(const Vec3& p) const { return {anterior_.dot(p), up_.dot(p)}; }

  std::span<const Landmark> landmarks_, frame_;
  Vec3 left_, anterior_, up_;
};

using Point = Profile::Point;

/// Angle from `from` to `to`, positive counter-clockwise with x anterior and y superior; -180 to
/// 180. Not finite if one of them has no length.
double turn_deg(const Point& from_mm, const Point& to_mm) {
  const Point from = Profile::unit(from_mm), to = Profile::unit(to_mm);
  const double cross = from.x() * to.y() - from.y() * to.x();
  return degrees_from_radians(std::atan2(cross, from.dot(to)));
}

/// Angle between the rays from `corner`, 0 to 180.
double angle_deg(const Point& a, const Point& corner, const Point& b) {
  return std::abs(turn_deg(a - corner, b - corner));
}

/// Distance of p anterior to the line from `above` to `below`; negative posterior to it.
double before_line(const Point& p, const Point& above, const Point& below) {
  const Point along = Profile::unit(below - above);
  const Point from = p - above;
  return along.x() * from.y() - along.y() * from.x();
}

constexpr const char* kHorizontal = "";  // Stands for orbitale and porion of the frame.

struct Definition {
  const char* name;
  const char* meaning;
  const char* unit;
  std::vector<std::string> needs;  ///< Landmarks, or midpoints of pairs.
  std::function<double(const Profile&)> value;
};

Definition distance(const char* name, const char* meaning, const char* a, const char* b) {
  return {
      name, meaning, "mm", {a, b}, [a, b](const Profile& at) { return (at(b) - at(a)).norm(); }};
}

std::vector<Definition> skeletal_angles() {
  using P = const Profile&;
  return {
      {"SNA",
       "maxilla to cranial base",
       "deg",
       {"S", "N", "A"},
       [](P at) { return angle_deg(at("S"), at("N"), at("A")); }},
      {"SNB",
       "mandible to cranial base",
       "deg",
       {"S", "N", "B"},
       [](P at) { return angle_deg(at("S"), at("N"), at("B")); }},
      {"ANB",
       "SNA minus SNB, maxilla to mandible",
       "deg",
       {"S", "N", "A", "B"},
       [](P at) {
         return angle_deg(at("S"), at("N"), at("A")) - angle_deg(at("S"), at("N"), at("B"));
       }},
      {"NAPg",
       "convexity of the bony face, positive if A is anterior to N-Pg",
       "deg",
       {"N", "A", "Pg"},
       [](P at) { return turn_deg(at("A") - at("N"), at("Pg") - at("A")) * -1.0; }},
      {"FH-NPg",
       "facial angle: Frankfurt horizontal to N-Pg",
       "deg",
       {kHorizontal, "N", "Pg"},
       [](P at) { return turn_deg(at("Pg") - at("N"), Point(-at.horizontal())) * -1.0; }},
      {"FH-MP",
       "Frankfurt horizontal to mandibular plane Go-Me, positive if it descends anteriorly",
       "deg",
       {kHorizontal, "Go", "Me"},
       [](P at) { return turn_deg(at("Me") - at("Go"), at.horizontal()); }},
      {"SN-MP",
       "cranial base S-N to mandibular plane Go-Me",
       "deg",
       {"S", "N", "Go", "Me"},
       [](P at) { return turn_deg(at("Me") - at("Go"), at("N") - at("S")); }},
      {"SN-PP",
       "cranial base S-N to palatal plane PNS-ANS",
       "deg",
       {"S", "N", "ANS", "PNS"},
       [](P at) { return turn_deg(at("ANS") - at("PNS"), at("N") - at("S")); }},
      {"ArGoMe",
       "gonial angle",
       "deg",
       {"Ar", "Go", "Me"},
       [](P at) { return angle_deg(at("Ar"), at("Go"), at("Me")); }},
  };
}

std::vector<Definition> soft_tissue_angles() {
  using P = const Profile&;
  return {
      {"N'SnPg'",
       "convexity of the soft-tissue profile, positive if Sn is anterior to N'-Pg'",
       "deg",
       {"N'", "Sn", "Pg'"},
       [](P at) { return turn_deg(at("Sn") - at("N'"), at("Pg'") - at("Sn")) * -1.0; }},
      {"PrnSnLs",
       "angle between nose and upper lip",
       "deg",
       {"Prn", "Sn", "Ls"},
       [](P at) { return angle_deg(at("Prn"), at("Sn"), at("Ls")); }},
  };
}

std::vector<Definition> profile_distances() {
  using P = const Profile&;
  return {
      distance("N-ANS", "upper facial height", "N", "ANS"),
      distance("ANS-Me", "lower facial height", "ANS", "Me"),
      distance("N-Me", "facial height", "N", "Me"),
      distance("S-Go", "posterior facial height", "S", "Go"),
      distance("ANS-PNS", "length of the palate", "ANS", "PNS"),
      distance("Co-A", "length of the midface", "Co", "A"),
      distance("Co-Gn", "length of the mandible", "Co", "Gn"),
      {"overjet",
       "U1 anterior to L1, along the Frankfurt horizontal",
       "mm",
       {kHorizontal, "U1", "L1"},
       [](P at) { return at.horizontal().dot(at("U1") - at("L1")); }},
      {"overbite",
       "U1 below L1, perpendicular to the Frankfurt horizontal",
       "mm",
       {kHorizontal, "U1", "L1"},
       [](P at) {
         const Point ahead = at.horizontal();
         return Point(-ahead.y(), ahead.x()).dot(at("L1") - at("U1"));
       }},
      {"Ls-E",
       "upper lip anterior to Ricketts' E-line Prn-Pg'",
       "mm",
       {"Ls", "Prn", "Pg'"},
       [](P at) { return before_line(at("Ls"), at("Prn"), at("Pg'")); }},
      {"Li-E",
       "lower lip anterior to Ricketts' E-line Prn-Pg'",
       "mm",
       {"Li", "Prn", "Pg'"},
       [](P at) { return before_line(at("Li"), at("Prn"), at("Pg'")); }},
  };
}

/// Distance anterior to the line through `origin` perpendicular to the Frankfurt horizontal.
Definition ahead_of(const char* name, const char* meaning, const char* point, const char* origin) {
  return {name, meaning, "mm", {kHorizontal, point, origin}, [point, origin](const Profile& at) {
            return at.horizontal().dot(at(point) - at(origin));
          }};
}

/// Distance below a point, perpendicular to the Frankfurt horizontal.
Definition height_of(const char* name, const char* meaning, const char* upper, const char* lower) {
  return {name, meaning, "mm", {kHorizontal, upper, lower}, [upper, lower](const Profile& at) {
            const Point ahead = at.horizontal();
            return Point(-ahead.y(), ahead.x()).dot(at(upper) - at(lower));
          }};
}

/// Distances from reference lines.
std::vector<Definition> line_distances() {
  using P = const Profile&;
  return {
      {"A-NPg",
       "A anterior to N-Pg (Ricketts' convexity)",
       "mm",
       {"A", "N", "Pg"},
       [](P at) { return before_line(at("A"), at("N"), at("Pg")); }},
      {"L1-APg",
       "L1 anterior to A-Pg",
       "mm",
       {"L1", "A", "Pg"},
       [](P at) { return before_line(at("L1"), at("A"), at("Pg")); }},
      ahead_of("A-Nperp", "A anterior to the vertical through N", "A", "N"),
      ahead_of("Pg-Nperp", "Pg anterior to the vertical through N", "Pg", "N"),
      ahead_of("Prn-TVL", "Prn anterior to the vertical through Sn", "Prn", "Sn"),
      ahead_of("A'-TVL", "A' anterior to the vertical through Sn", "A'", "Sn"),
      ahead_of("Ls-TVL", "Ls anterior to the vertical through Sn", "Ls", "Sn"),
      ahead_of("Li-TVL", "Li anterior to the vertical through Sn", "Li", "Sn"),
      ahead_of("B'-TVL", "B' anterior to the vertical through Sn", "B'", "Sn"),
      ahead_of("Pg'-TVL", "Pg' anterior to the vertical through Sn", "Pg'", "Sn"),
      height_of("N'-Me'", "height of the soft-tissue face", "N'", "Me'"),
      height_of("Sn-Me'", "height of its lower third", "Sn", "Me'"),
  };
}

std::vector<Definition> definitions() {
  std::vector<Definition> all = skeletal_angles();
  for (auto& more : {soft_tissue_angles(), profile_distances(), line_distances()})
    all.insert(all.end(), more.begin(), more.end());
  return all;
}

/// Distance between the two landmarks of a pair.
struct Width {
  const char* pair;
  const char* meaning;
};
constexpr Width kWidths[] = {{"Zy", "width of the face at the zygomatic arches"},
                             {"FZ", "width between the frontozygomatic points"},
                             {"Or", "width between the lower orbital rims"},
                             {"Go", "width of the mandible"},
                             {"U6", "width of the upper dental arch"},
                             {"En", "width between the inner corners of the eyes"},
                             {"Ex", "width between the outer corners of the eyes"},
                             {"Al", "width of the nose"},
                             {"Ch", "width of the mouth"}};

}  // namespace

Result<std::vector<Measurement>> measure(std::span<const Landmark> landmarks,
                                         std::span<const Landmark> frame) {
  LEFORT_TRY(const Vec3 left, patient_left_axis(frame));
  const Profile profile(landmarks, frame, left);
  std::vector<Measurement> table;
  for (const Definition& one : definitions()) {
    Measurement line{one.name, one.meaning, one.unit, std::nullopt};
    const bool is_known =
        std::all_of(one.needs.begin(), one.needs.end(), [&](const std::string& name) {
          return name == kHorizontal ? profile.has_horizontal() : profile.has(name);
        });
    if (is_known) line.value = one.value(profile);
    if (line.value && !std::isfinite(*line.value)) line.value.reset();  // Two points coincide.
    table.push_back(std::move(line));
  }
  for (const auto& [pair, meaning] : kWidths) {
    Measurement line{std::string(pair) + "-R-" + pair + "-L", meaning, "mm", std::nullopt};
    if (profile.has_both(pair)) line.value = profile.width(pair);
    table.push_back(std::move(line));
  }
  return table;
}

Result<std::vector<Measurement>> measure(std::span<const Landmark> landmarks) {
  return measure(landmarks, landmarks);
}

}  // namespace lefort::plan
