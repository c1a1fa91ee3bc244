#include <lefort/io/point_table.h>

#include <gtest/gtest.h>

namespace lefort::io::test_point_table {
namespace {

TEST(PointTable, ReadsCommasSpacesHeadingsAndComments) {
  const auto points =
      parse_points("x,y,z\n# note\n1,2,3\n  4 5\t6  extra\r\n\n-1e-3;+2;.5,more\n").value();
  ASSERT_EQ(points.size(), 3U);
  EXPECT_EQ(points[0], Vec3(1.0, 2.0, 3.0));
  EXPECT_EQ(points[1], Vec3(4.0, 5.0, 6.0));
  EXPECT_EQ(points[2], Vec3(-1e-3, 2.0, 0.5));
}

TEST(PointTable, NamesTheLineWithoutPoint) {
  for (const char* text : {"1 2 3\n4 5\n", "1 2 3\n1 2 nan\n", "1 2 3\nx y z\n", "1 2 3\n1 2 3a\n",
                           "1 2 3\n1e999 0 0\n"}) {
    const auto points = parse_points(text);
    ASSERT_FALSE(points) << text;
    EXPECT_EQ(points.error().code, ErrorCode::kFileCorrupt);
    EXPECT_NE(points.error().message.find("line 2"), std::string::npos) << points.error().message;
  }
}

TEST(PointTable, RejectsATableWithoutPoints) {
  EXPECT_FALSE(parse_points(""));
  EXPECT_FALSE(parse_points("x y z\n"));
  EXPECT_EQ(read_points("/nonexistent.csv").error().code, ErrorCode::kFileNotFound);
}

}  // namespace
}  // namespace lefort::io::test_point_table
