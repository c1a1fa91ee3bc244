#include <lefort/core/version.h>
#include <lefort/report/annotate.h>
#include <lefort/report/picture.h>
#include <lefort/report/report_html.h>

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>

#include "report/find_text.h"
#include "report/well_formed.h"

namespace lefort::report::test_report_html {
namespace {

using test::between;
using test::count;

std::string png() { return encode_png({2, 1, {255, 0, 0, 255, 0, 0, 255, 255}}).value(); }

CaseReport example() {
  CaseReport report;
  report.title = "Midface, 6 mm forward";
  report.subtitle = "a case";
  report.plan = "The midface moves 6 mm forward in 12 steps.";
  report.converged = true;
  report.comparisons = {{"front", "drag to compare", png(), png()}};
  report.pictures = {{"displacement", "in mm", png()}};
  report.key_numbers = {{"largest displacement", "5.83 mm"}};
  report.tables = {{"by region", {"region", "mean [mm]"}, {{"upper lip", "4.91"}, {"nose"}}}};
  report.steps = {{0.5, {1.0, 1e-3, 1e-8}, 0.11, 0.02}, {1.0, {1.0, 1e-7}, 0.13, 0.03}};
  report.notes = {"the scan ends under the upper lip"};
  report.provenance = {{"CT", "sha256 0123abcd"}};
  report.limitations = {"No muscle acts."};
  return report;
}

std::string decode_base64(std::string_view text) {
  const std::string_view alphabet =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned bits = 0;
  int held = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = bits << 6U | unsigned(alphabet.find(c));
    held += 6;
    if (held < 8) continue;
    held -= 8;
    bytes += char(bits >> unsigned(held) & 0xffU);
  }
  return bytes;
}

TEST(ReportHtml, IsWellFormed) {
  EXPECT_EQ(test::fault_of(report_html(example())), "");
  EXPECT_EQ(test::fault_of(report_html({})), "");
}

TEST(ReportHtml, ContainsAllContentOfTheReport) {
  const std::string html = report_html(example());
  for (const std::string text :
       {"Midface, 6 mm forward", "The midface moves 6 mm forward in 12 steps.",
        "largest displacement", "5.83 mm", "mean [mm]", "upper lip", "4.91",
        "the scan ends under the upper lip", "sha256 0123abcd", "No muscle acts.",
        "drag to compare", kNotForClinicalUse, kVersion})
    EXPECT_NE(html.find(text), html.npos) << text;
  EXPECT_EQ(count(html, "<svg"), 2U);
  // Pictures before numbers, numbers before tables, provenance and limitations last.
  EXPECT_LT(html.find("<figure"), html.find("5.83 mm"));
  EXPECT_LT(html.find("5.83 mm"), html.find("4.91"));
  EXPECT_LT(html.find("<svg"), html.find("sha256"));
  EXPECT_LT(html.find("sha256"), html.find("No muscle acts."));
}

TEST(ReportHtml, ContainsThePicturesByteForByte) {
  const std::string html = report_html(example());
  const std::vector<std::string> pictures = between(html, "data:image/png;base64,", "\"");
  EXPECT_EQ(pictures.size(), 3U);
  for (const std::string& picture : pictures) EXPECT_EQ(decode_base64(picture), png());
}

TEST(ReportHtml, LoadsNoExternalResources) {
  const std::string html = report_html(example());
  EXPECT_NE(html.find("default-src 'none'"), html.npos);
  EXPECT_EQ(count(html, " src="), count(html, " src=\"data:"));
  EXPECT_EQ(count(html, "href=") + count(html, "url(") + count(html, "@import"), 0U);
}

TEST(ReportHtml, EscapesEveryText) {
  const std::string evil = "<script>alert('x')</script>\"'& \x01\xc3(\xed\xa0\x80 \xef\xbf\xbf";
  CaseReport report;
  report.title = report.subtitle = report.plan = report.failure = evil;
  report.comparisons = {{evil, evil, evil, evil}};
  report.pictures = {{evil, evil, evil}};
  report.key_numbers = {{evil, evil}};
  report.tables = {{evil, {evil}, {{evil, evil, evil}, {}}}};
  report.steps = {{std::nan(""), {std::nan(""), -1.0, INFINITY}, NAN, -INFINITY}};
  report.notes = report.limitations = {evil};
  report.provenance = {{evil, evil}};
  for (const bool converged : {true, false}) {
    report.converged = converged;
    const std::string html = report_html(report);
    EXPECT_EQ(test::fault_of(html), "");
    EXPECT_EQ(count(html, "<script"), 0U);
    EXPECT_EQ(count(html, "\x01") + count(html, "\xc3(") + count(html, "\xed\xa0"), 0U);
    EXPECT_GT(count(html, "\uFFFD"), 10U);
  }
}

TEST(ReportHtml, MarksAnUnconvergedResultOnThePageAndOnEveryPicture) {
  CaseReport report = example();
  EXPECT_EQ(count(report_html(report), "NOT CONVERGED"), 0U);
  report.converged = false;
  report.failure = "step 7: no step lowers |r|";
  const std::string html = report_html(report);
  // Title, header, one comparison, one picture, and over the key numbers.
  EXPECT_EQ(count(html, "NOT CONVERGED"), 5U);
  EXPECT_EQ(count(html, kNotConvergedBanner), 4U);
  EXPECT_NE(html.find("step 7: no step lowers |r|"), html.npos);
  EXPECT_LT(html.find(kNotConvergedBanner), html.find("<figure"));
}

/// WCAG 2.1, relative luminance of "#rrggbb".
double luminance(const std::string& hex) {
  double sum = 0.0;
  const double weights[3] = {0.2126, 0.7152, 0.0722};
  for (int c = 0; c < 3; ++c) {
    const double value = std::stoi(hex.substr(std::size_t(1 + 2 * c), 2), nullptr, 16) / 255.0;
    sum += weights[c] * (value <= 0.03928 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4));
  }
  return sum;
}

TEST(ReportHtml, TextHasTheContrastOfWcagAa) {
  const std::string html = report_html(example());
  const std::vector<std::string> schemes = between(html, ":root {", "}");
  ASSERT_EQ(schemes.size(), 3U);              // Light, dark, paper.
  std::map<std::string, std::string> colors;  // A later scheme inherits the colors of earlier ones.
  for (const std::string& scheme : schemes) {
    for (const std::string& variable : between(scheme, "--", ";"))
      colors[variable.substr(0, variable.find(':'))] = variable.substr(variable.find('#'));
    const std::pair<const char*, const char*> pairs[] = {
        {"ink", "ground"},  {"muted", "ground"},           {"ink", "panel"},
        {"muted", "panel"}, {"alarm-ink", "alarm-ground"}, {"caution-ink", "caution-ground"}};
    for (const auto& [ink, ground] : pairs) {
      const double a = luminance(colors.at(ink));
      const double b = luminance(colors.at(ground));
      EXPECT_GE((std::max(a, b) + 0.05) / (std::min(a, b) + 0.05), 4.5)
          << ink << " on " << ground << " in" << scheme;
    }
  }
}

}  // namespace
}  // namespace lefort::report::test_report_html
