#include <lefort/report/plot_lines.h>
#include <lefort/report/solver_plots.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "report/find_text.h"
#include "report/well_formed.h"

namespace lefort::report::test_plot_lines {
namespace {

using test::between;
using test::count;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The values of attribute `name` of all elements `tag`.
std::vector<double> values(const std::string& svg, const std::string& tag,
                           const std::string& name) {
  std::vector<double> found;
  for (const std::string& element : between(svg, "<" + tag + " ", ">"))
    for (const std::string& value : between(" " + element, " " + name + "='", "'"))
      found.push_back(std::stod(value));
  return found;
}

TEST(PlotLines, PointsAreAtTheirValues) {
  const std::string svg = plot_lines({.lines = {{"a", {0.0, 1.0, 4.0}, {0.0, 2.0, 1.0}}}});
  const auto x = values(svg, "circle", "cx");
  const auto y = values(svg, "circle", "cy");
  ASSERT_EQ(x.size(), 3U);
  EXPECT_NEAR((x[1] - x[0]) / (x[2] - x[0]), 0.25, 1e-3);
  EXPECT_NEAR((y[2] - y[0]) / (y[1] - y[0]), 0.5, 1e-3);
  EXPECT_LT(y[1], y[0]);  // Larger is higher.
}

TEST(PlotLines, LogAxisMapsEqualRatiosToEqualDistances) {
  const std::string svg =
      plot_lines({.y_axis = Axis::kLog, .lines = {{"a", {1.0, 2.0, 3.0}, {1.0, 1e-3, 1e-6}}}});
  const auto y = values(svg, "circle", "cy");
  ASSERT_EQ(y.size(), 3U);
  EXPECT_NEAR(y[1] - y[0], y[2] - y[1], 0.02);
  EXPECT_GT(y[1], y[0]);
}

TEST(PlotLines, InvalidValuesInterruptTheLine) {
  const std::string svg = plot_lines({.y_axis = Axis::kLog,
                                      .lines = {{"a",
                                                 {1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0},
                                                 {1.0, 0.1, 0.0, 0.2, kNan, kInfinity, 0.3}}}});
  EXPECT_EQ(values(svg, "circle", "cx").size(), 4U);
  const std::vector<std::string> paths = between(svg, "<path d='", "'");
  ASSERT_EQ(paths.size(), 1U);
  EXPECT_EQ(count(paths[0], "M"), 3U);
  EXPECT_EQ(count(svg, "nan"), 0U);
  EXPECT_EQ(count(svg, "inf"), 0U);
}

TEST(PlotLines, FileHasFixedColors) {
  const LinePlot plot{.title = "t", .lines = {{.name = "a", .x = {0, 1}, .y = {1, 2}}}};
  EXPECT_NE(plot_lines(plot).find("var(--"), std::string::npos);
  EXPECT_EQ(plot_file(plot).find("var("), std::string::npos);
}

TEST(PlotLines, ManyLinesHaveDashesAndALegendOfSeveralRows) {
  LinePlot plot;
  for (const char* name :
       {"tet4", "pyramid5", "wedge6", "hex8", "tet10", "wedge15", "hex20", "reference"})
    plot.lines.push_back({name, {1.0, 2.0}, {1.0, 2.0}});
  const std::string svg = plot_lines(plot);
  std::set<std::string> styles;
  for (const std::string& style : between(svg, "fill:none;", "'")) styles.insert(style);
  EXPECT_EQ(styles.size(), 8U);
  const auto y = values(svg, "text", "y");
  EXPECT_EQ(std::count(y.begin(), y.end(), 44.0), 1);  // A second row, of one name.
  EXPECT_NE(svg.find("viewBox='0 -18 720 348'"), std::string::npos);
}

TEST(PlotLines, StaysWellFormedAndFiniteForAnyInput) {
  const std::string hostile = "</svg><script>alert(1)</script> & \"'\x01\xff";
  const std::vector<LinePlot> plots{
      {},
      {.title = hostile,
       .x_label = hostile,
       .y_label = hostile,
       .lines = {{hostile, {1}, {1}}},
       .dividers_x = {kNan, -5.0, kInfinity},
       .threshold_y = 0.5,
       .threshold_name = hostile},
      {.lines = {{"a", {0.0, 1.0}, {-1e308, 1e308}}}},
      {.lines = {{"a", {1e99, 1e99}, {5e-324, 1e-300}}}, .threshold_y = kNan},
      {.y_axis = Axis::kLog,
       .lines = {{"a", {1.0}, {5e-324}}, {"b", {1.0}, {1e308}}},
       .threshold_y = -1.0}};
  for (const LinePlot& plot : plots) {
    const std::string svg = plot_lines(plot);
    EXPECT_EQ(test::fault_of(svg), "");
    EXPECT_EQ(count(svg, "nan") + count(svg, "inf"), 0U) << svg;
    EXPECT_EQ(count(svg, "<script"), 0U);
  }
}

TEST(SolverPlots, ResidualsAreContinuousWithDividersBetweenSteps) {
  const std::vector<SolverStep> steps{{0.5, {1.0, 1e-4, 1e-9}, 0.1, 0.05},
                                      {1.0, {1.0, 1e-7}, 0.2, 0.1}};
  const LinePlot plot = residual_plot(steps, 1e-6);
  ASSERT_EQ(plot.lines.size(), 2U);
  EXPECT_EQ(plot.lines[0].x, (std::vector<double>{1.0, 2.0, 3.0}));
  EXPECT_EQ(plot.lines[1].x, (std::vector<double>{4.0, 5.0}));
  EXPECT_EQ(plot.lines[1].y, steps[1].relative_residuals);
  EXPECT_EQ(plot.dividers_x, (std::vector<double>{3.5}));
  EXPECT_EQ(plot.threshold_y, 1e-6);
  EXPECT_EQ(count(plot_lines(plot), ">residual<"), 1U);  // One name, one legend entry.
}

TEST(SolverPlots, PenetrationIsPlottedOverThePath) {
  const std::vector<SolverStep> steps{{0.5, {}, 0.1, 0.05}, {1.0, {}, 0.2, 0.1}};
  const LinePlot plot = penetration_plot(steps);
  EXPECT_EQ(plot.lines[0].x, (std::vector<double>{50.0, 100.0}));
  EXPECT_EQ(plot.lines[0].y, (std::vector<double>{0.1, 0.2}));
  EXPECT_EQ(plot.lines[1].y, (std::vector<double>{0.05, 0.1}));
}

}  // namespace
}  // namespace lefort::report::test_plot_lines
