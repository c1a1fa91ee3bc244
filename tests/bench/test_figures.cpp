#include <lefort/bench/figures.h>

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace lefort::bench::test_figures {
namespace {

using Json = nlohmann::ordered_json;

Json run_of(const char* method, int threads, double seconds, double rate) {
  return {{"method", method},
          {"resolution", 128},
          {"threads", threads},
          {"result", {{"seconds", seconds}, {"rates", {{"value", rate}}}}}};
}

TEST(Figures, ATableHasRatiosOfTheSameRun) {
  const Json table1 = {run_of("bricks", 1, 0.1, 8e6), run_of("bricks", 2, 0.05, 8e6),
                       run_of("openvdb", 1, 1.2, 1e6)};
  const std::vector<Figure> figures = figures_of_table1(table1);
  ASSERT_EQ(figures.size(), 3U);
  EXPECT_NEAR(figures[0].value, 12.0, 1e-12);  // Build.
  EXPECT_NEAR(figures[1].value, 8.0, 1e-12);   // Queries.
  EXPECT_NEAR(figures[2].value, 2.0, 1e-12);   // Threads.
  EXPECT_EQ(figures[0].peer, "OpenVDB");
}

TEST(Figures, ARunWithoutItsPeerHasNoRatio) {
  EXPECT_TRUE(figures_of_table1(Json::array({run_of("bricks", 1, 0.1, 8e6)})).empty());
  EXPECT_TRUE(figures_of_solve(Json::object()).empty());
}

TEST(Figures, ContactIsComparedByTheFastestFormulation) {
  const Json contact = {{"lefort, quadrature", {{"seconds", 4.0}, {"force_z_n", -2.28}}},
                        {"lefort, weighted", {{"seconds", 5.0}, {"force_z_n", -2.29}}},
                        {"CalculiX, node to surface", {{"seconds", 100.0}, {"force_z_n", -2.3}}},
                        {"CalculiX, mortar", {{"failure", "CalculiX ended with 201"}}}};
  const std::vector<Figure> figures = figures_of_contact(contact);
  ASSERT_EQ(figures.size(), 5U);
  EXPECT_NEAR(figures.back().value, 25.0, 1e-12);
  EXPECT_EQ(figures.back().peer, "CalculiX, node to surface");
  EXPECT_FALSE(figures.back().is_ratio());
}

TEST(Figures, ALossBeyondTheThresholdIsFound) {
  const std::vector<Figure> before{{.name = "a", .value = 10.0, .peer = "p"},
                                   {.name = "b", .value = 4.0, .peer = "p"},
                                   {.name = "c", .value = 3.0, .unit = "s"}};
  const Json stored = to_json(before);
  EXPECT_TRUE(find_regressions(before, stored, 0.0).empty());
  std::vector<Figure> now = before;
  now[0].value = 8.6;
  now[2].value = 30.0;  // Seconds depend on the machine.
  EXPECT_TRUE(find_regressions(now, stored, 0.15).empty());
  now[0].value = 8.4;
  const std::vector<std::string> found = find_regressions(now, stored, 0.15);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0], "a over p: 8.4 times, stored 10");
}

TEST(Figures, AStoredRatioThatIsNotMeasuredIsFound) {
  const Json stored = to_json(std::vector<Figure>{{.name = "a", .value = 10.0, .peer = "p"}});
  EXPECT_EQ(find_regressions({}, stored, 0.15).size(), 1U);
  EXPECT_TRUE(find_regressions({}, Json(), 0.15).empty());
}

}  // namespace
}  // namespace lefort::bench::test_figures
