#include <lefort/compare/published_ratios.h>
#include <lefort/plan/landmarks.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "support/run_python.h"
#include "support/temporary_folder.h"

namespace lefort::compare::test_published_ratios {
namespace {

TEST(PublishedRatios, NameKnownLandmarksAndSources) {
  ASSERT_FALSE(published_ratios().empty());
  for (const PublishedRatio& row : published_ratios()) {
    EXPECT_LE(row.low, row.high) << row.source;
    EXPECT_GT(row.low, 0.0) << row.source;
    const std::string soft(row.soft), hard(row.hard);
    const plan::LandmarkKind* kind = plan::landmark_definition(soft);
    if (kind == nullptr) kind = plan::landmark_definition(soft + "-L");
    if (row.soft != kUpperLip) {
      ASSERT_NE(kind, nullptr) << soft;
      EXPECT_TRUE(kind->is_soft) << soft;
    }
    if (row.hard != kSegment) {
      ASSERT_NE(plan::landmark_definition(hard), nullptr) << hard;
      EXPECT_FALSE(plan::landmark_definition(hard)->is_soft) << hard;
    }
    EXPECT_TRUE(std::any_of(ratio_sources().begin(), ratio_sources().end(),
                            [&](const RatioSource& source) {
                              return source.key == row.source && !source.label.empty() &&
                                     !source.reference.empty();
                            }))
        << row.source;
  }
}

/// Procedures for which studies give ratios.
TEST(PublishedRatios, CoverTheUsualProcedures) {
  const auto is_covered = [](Procedure procedure, Direction direction) {
    return std::any_of(published_ratios().begin(), published_ratios().end(),
                       [&](const PublishedRatio& row) {
                         return row.procedure == procedure && row.direction == direction;
                       });
  };
  EXPECT_TRUE(is_covered(Procedure::kLeFort1, Direction::kAdvancement));
  EXPECT_TRUE(is_covered(Procedure::kLeFort1, Direction::kImpaction));
  EXPECT_TRUE(is_covered(Procedure::kSagittalSplit, Direction::kAdvancement));
  EXPECT_TRUE(is_covered(Procedure::kSagittalSplit, Direction::kSetback));
  EXPECT_TRUE(is_covered(Procedure::kGenioplasty, Direction::kAdvancement));
  EXPECT_FALSE(is_covered(Procedure::kGenioplasty, Direction::kSetback)) << "none was found";
  EXPECT_TRUE(is_covered(Procedure::kExpansion, Direction::kWidening));
  EXPECT_TRUE(is_covered(Procedure::kMidfaceDistraction, Direction::kAdvancement));
}

TEST(PublishedRatios, RangeIsThatOfAllRows) {
  using enum FaceAxis;
  const PublishedRatio rows[] = {
      {Procedure::kLeFort1, Direction::kAdvancement, kAnterior, "Ls", "U1", 0.7, 0.9, "a", false},
      {Procedure::kLeFort1, Direction::kAdvancement, kAnterior, "Ls", "U1", 0.5, 0.5, "b", true},
      {Procedure::kLeFort1, Direction::kAdvancement, kAnterior, "Ls", "U1", 0.8, 0.8, "a", false}};
  EXPECT_FALSE(range_of({}));
  const PublishedRange range = *range_of(rows);
  EXPECT_EQ(range.low, 0.5);
  EXPECT_EQ(range.high, 0.9);
  EXPECT_EQ(range.sources, (std::vector<std::string_view>{"a", "b"}));
  EXPECT_TRUE(range.is_recalled);
  EXPECT_TRUE(range.contains(0.5));
  EXPECT_FALSE(range.contains(0.49));
  EXPECT_FALSE(range.contains(0.91));
  const PublishedRange mean = *range_of(std::span(rows).subspan(1, 1));
  EXPECT_TRUE(mean.contains(0.59)) << "a single mean stands for the mean plus or minus 0.1";
  EXPECT_FALSE(mean.contains(0.61));
  EXPECT_FALSE(range_of(std::span(rows).subspan(0, 1))->is_recalled);
}

/// The program never parses the table: a broken one stops the build, with its line.
class TableOfRatios : public testing::Test {
 protected:
  /// Output of the generator for a table with this row; empty if it accepts the row.
  std::string refusal(const std::string& row) {
    const std::string head =
        "procedure,direction,soft_landmark,hard_landmark,axis,ratio_low,ratio_high,source_key,"
        "basis,note\n";
    std::ofstream(folder_ / "table.csv") << head << row << "\n";
    const std::string script =
        "import subprocess, sys; folder = sys.argv[1]; sys.exit(subprocess.run([sys.executable, "
        "\"" LEFORT_SOURCE
        "/cmake/embed_soft_tissue_ratios.py\", folder + \"/table.csv\", "
        "\"" LEFORT_SOURCE "/docs/references.bib\", folder + \"/table.cpp\"]).returncode)";
    const auto [accepted, output] = test::run_python(script, folder_.path().string());
    return accepted ? "" : output;
  }
  test::TemporaryFolder folder_;
};

TEST_F(TableOfRatios, IsRejectedWithItsLineBeforeItIsCompiled) {
  EXPECT_EQ(refusal("le-fort-1,advancement,Ls,U1,anterior,0.69,0.95,rosen1988,abstract,41"), "");
  const std::pair<const char*, const char*> bad[] = {
      {"le-fort-9,advancement,Ls,U1,anterior,0.69,0.95,rosen1988,abstract,", "procedure"},
      {"le-fort-1,impaction,Ls,U1,anterior,0.69,0.95,rosen1988,abstract,", "no movement along"},
      {"le-fort-1,advancement,Lx,U1,anterior,0.69,0.95,rosen1988,abstract,", "soft_landmark"},
      {"le-fort-1,advancement,Ls,Ls,anterior,0.69,0.95,rosen1988,abstract,", "hard_landmark"},
      {"le-fort-1,advancement,Ls,U1,anterior,0.95,0.69,rosen1988,abstract,", "exceeds"},
      {"le-fort-1,advancement,Ls,U1,anterior,0.69,nan,rosen1988,abstract,", "not finite"},
      {"le-fort-1,advancement,Ls,U1,anterior,0.69,high,rosen1988,abstract,", "not numbers"},
      {"le-fort-1,advancement,Ls,U1,anterior,0.69,0.95,nobody1900,abstract,", "source_key"},
      {"le-fort-1,advancement,Ls,U1,anterior,0.69,0.95,rosen1988,guess,", "basis"},
      {"le-fort-1,advancement,Ls,U1,anterior,0.69,0.95,rosen1988", "10 cells"}};
  for (const auto& [row, reason] : bad) {
    const std::string output = refusal(row);
    EXPECT_NE(output.find(reason), std::string::npos) << row << "\n" << output;
    EXPECT_NE(output.find("table.csv:2"), std::string::npos) << output;
  }
}

}  // namespace
}  // namespace lefort::compare::test_published_ratios
