#include <lefort/geometry/rigid_motion.h>
#include <lefort/plan/cephalometrics.h>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace lefort::plan::test_cephalometrics {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

/// A head with known angles: nasion at the origin, in LPS (anterior is -y).
Landmarks head() {
  const auto below_nasion = [](double turned_deg, double length_mm) {
    // S lies posterior to N at the same height: the ray N-S is +y, rotated down by the angle.
    return Vec3(0.0, length_mm * std::cos(turned_deg * kDegree),
                -length_mm * std::sin(turned_deg * kDegree));
  };
  return {{"N", {0, 0, 0}},
          {"S", {0, 70, 0}},
          {"A", below_nasion(82, 60)},
          {"B", below_nasion(78, 100)},
          {"Or-R", {-35, 10, -30}},
          {"Or-L", {35, 10, -30}},
          {"Po-R", {-60, 100, -30}},
          {"Po-L", {60, 100, -30}},
          {"U1", {0, 0, -80}},
          {"L1", {0, 3, -78}},
          {"Go-R", {-45, 80, -90}},
          {"Go-L", {45, 80, -90}},
          {"Me", {0, 80 - 60, -90 - 60 * std::tan(25 * kDegree)}}};
}

std::vector<Measurement> table_of(const Landmarks& landmarks) { return measure(landmarks).value(); }

double value(const Landmarks& landmarks, const std::string& name) {
  for (const Measurement& line : table_of(landmarks))
    if (line.name == name) return line.value.value();
  throw std::runtime_error("no line " + name);
}

TEST(Cephalometrics, AnglesEqualTheKnownOnes) {
  EXPECT_NEAR(value(head(), "SNA"), 82.0, 1e-9);
  EXPECT_NEAR(value(head(), "SNB"), 78.0, 1e-9);
  EXPECT_NEAR(value(head(), "ANB"), 4.0, 1e-9);
  EXPECT_NEAR(value(head(), "FH-MP"), 25.0, 1e-9);
  EXPECT_NEAR(value(head(), "SN-MP"), 25.0, 1e-9);
}

TEST(Cephalometrics, OverjetAndOverbiteArePositiveForNormalOcclusion) {
  EXPECT_NEAR(value(head(), "overjet"), 3.0, 1e-9);
  EXPECT_NEAR(value(head(), "overbite"), 2.0, 1e-9);
}

TEST(Cephalometrics, WidthsAreInSpaceAndHeightsInLateralProjection) {
  Landmarks landmarks = head();
  EXPECT_NEAR(value(landmarks, "Or-R-Or-L"), 70.0, 1e-12);
  landmarks.push_back({"ANS", {8, 2, -50}});  // Off the mid-plane.
  EXPECT_NEAR(value(landmarks, "N-ANS"), std::hypot(2.0, 50.0), 1e-9);
}

TEST(Cephalometrics, SignsOfProfileLines) {
  const Landmarks profile{{"Prn", {0, -20, 0}},   {"Pg'", {0, 0, -60}},   {"Ls", {0, -15, -30}},
                          {"Li", {0, 0, -40}},    {"N'", {0, 0, 40}},     {"Sn", {0, -10, -5}},
                          {"N", {0, 0, 40}},      {"A", {0, -6, -10}},    {"Pg", {0, 0, -60}},
                          {"Or-R", {-30, 0, 20}}, {"Po-R", {-60, 90, 20}}};
  EXPECT_GT(value(profile, "Ls-E"), 0.0);
  EXPECT_LT(value(profile, "Li-E"), 0.0);
  EXPECT_GT(value(profile, "N'SnPg'"), 0.0);
  EXPECT_GT(value(profile, "NAPg"), 0.0);
  Landmarks concave = profile;
  concave[7].point_L.y() = 6.0;
  EXPECT_LT(value(concave, "NAPg"), 0.0);
  EXPECT_NEAR(value(profile, "FH-NPg"), 90.0, 1e-9);
  Landmarks chin = profile;
  chin[8].point_L.y() = -10.0;  // A prominent chin increases the facial angle.
  EXPECT_GT(value(chin, "FH-NPg"), 90.0);
}

TEST(Cephalometrics, ValuesAreInvariantToTheOrientationOfTheHead) {
  const Landmarks before = head();
  Landmarks after = before;
  const RigidTransform X = geometry::rigid_motion({10, -20, 30}, {0.1, -0.05, 0.3}, {5, 6, 7});
  for (Landmark& landmark : after) landmark.point_L = X * landmark.point_L;
  const auto a = table_of(before), b = table_of(after);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].value.has_value(), b[i].value.has_value()) << a[i].name;
    if (a[i].value) {
      EXPECT_NEAR(*a[i].value, *b[i].value, 1e-9) << a[i].name;
    }
  }
}

TEST(Cephalometrics, MissingLandmarksGiveNoValue) {
  for (const Measurement& line : table_of(Landmarks{})) EXPECT_FALSE(line.value) << line.name;
}

TEST(Cephalometrics, UndefinedValuesAreNotReported) {
  Landmarks landmarks = head();
  const auto without = [&](const char* moved, const char* onto, const char* line) {
    Landmarks degenerate = landmarks;
    for (Landmark& one : degenerate)
      if (one.name == moved) one.point_L = *find_landmark(landmarks, onto);
    for (const Measurement& measured : table_of(degenerate)) {
      if (measured.name != line) continue;
      EXPECT_FALSE(measured.value) << line;
    }
  };
  without("A", "N", "SNA");
  without("A", "N", "ANB");
  without("S", "N", "SN-MP");
  landmarks.push_back({"Or", {0, 10, -30}});  // The name without a side has priority.
  landmarks.push_back({"Po", {0, 100, -30}});
  without("Po", "Or", "overjet");
  without("Po", "Or", "FH-MP");
  landmarks.insert(landmarks.end(),
                   {{"Prn", {0, -20, 0}}, {"Pg'", {0, 0, -60}}, {"Ls", {0, 1, 2}}});
  without("Pg'", "Prn", "Ls-E");
}

/// A mobilized midface moves the orbits, too; overjet must not depend on them.
TEST(Cephalometrics, FrameCanBeThatBeforeSurgery) {
  const Landmarks before = head();
  Landmarks after = before;
  for (Landmark& landmark : after)
    if (landmark.name.starts_with("Or")) landmark.point_L += Vec3(0, -12, -5);
  const auto of = [](const std::vector<Measurement>& table, const char* name) {
    for (const Measurement& line : table)
      if (line.name == name) return line.value.value();
    return std::nan("");
  };
  const auto in_frame = measure(after, before).value();
  for (const char* name : {"overjet", "overbite", "FH-MP"})
    EXPECT_EQ(of(in_frame, name), value(before, name)) << name;
  EXPECT_GT(std::abs(value(after, "FH-MP") - value(before, "FH-MP")), 2.0);
  after = before;
  std::erase_if(after, [](const Landmark& one) { return one.name.starts_with("Po"); });
  EXPECT_EQ(of(measure(after, before).value(), "overjet"), value(before, "overjet"));
}

TEST(Cephalometrics, RejectsExchangedSides) {
  Landmarks landmarks = head();
  std::swap(landmarks[4].point_L, landmarks[5].point_L);
  const auto table = measure(landmarks);
  ASSERT_FALSE(table);
  EXPECT_NE(table.error().message.find("Or-R and Or-L"), std::string::npos);
}

}  // namespace
}  // namespace lefort::plan::test_cephalometrics
