#include <lefort/io/surface_files.h>
#include <lefort/io/vertex_array.h>
#include <lefort/io/write_atomically.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace lefort::io::test_vertex_array {
namespace {

TEST(VertexArray, ReadsBackTheSameNumbers) {
  const test::TemporaryFolder folder;
  const auto sheet = test::make_sheet(4.0, 3);
  std::vector<double> values;
  for (std::size_t v = 0; v < sheet.vertices.size(); ++v) values.push_back(0.1 * double(v));
  values[3] = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Vec3> vectors(sheet.vertices.size(), Vec3::UnitX());
  ASSERT_TRUE(write_surface(folder / "a.vtp", sheet, {{"depth_mm", values}, {"way_mm", vectors}}));
  const auto read = read_vertex_array(folder / "a.vtp", "depth_mm").value();
  ASSERT_EQ(read.size(), values.size());
  for (std::size_t v = 0; v < read.size(); ++v) {
    if (v == 3)
      EXPECT_TRUE(std::isnan(read[v]));
    else
      EXPECT_EQ(read[v], values[v]);
  }
  for (const char* name : {"way_mm", "depth", "Points"}) {
    const auto none = read_vertex_array(folder / "a.vtp", name);
    ASSERT_FALSE(none) << name;
    EXPECT_EQ(none.error().code, ErrorCode::kFileCorrupt) << name;
  }
}

TEST(VertexArray, RejectsOtherFilesThanVtp) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_text(folder / "b.vtp", "<VTKFile"));
  EXPECT_EQ(read_vertex_array(folder / "b.vtp", "depth_mm").error().code, ErrorCode::kFileCorrupt);
  EXPECT_EQ(read_vertex_array(folder / "c.vtp", "depth_mm").error().code, ErrorCode::kFileNotFound);
}

}  // namespace
}  // namespace lefort::io::test_vertex_array
