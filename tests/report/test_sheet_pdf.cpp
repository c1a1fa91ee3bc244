#include <lefort/report/draw_cephalogram.h>
#include <lefort/report/sheet_pdf.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <string_view>

namespace lefort::report {
namespace {

Sheet small_sheet() {
  Sheet sheet;
  sheet.title = "Worksheet: caf\u00e9 \u2013 plan";
  sheet.lines = {"A line.", std::string(600, 'x') + " and words after a long one"};
  Picture picture{4, 3, std::vector<std::uint8_t>(48, 200)};
  sheet.pictures = {{"front", "", encode_png(picture).value()}};
  sheet.tables = {{"Movements", {"segment", "anterior"}, {{"maxilla", "5.0 forward"}}}};
  return sheet;
}

int pages_of(const std::string& pdf) {
  int pages = 0;
  for (std::size_t at = pdf.find("/Type /Page "); at != std::string::npos;
       at = pdf.find("/Type /Page ", at + 1))
    ++pages;
  return pages;
}

TEST(SheetPdf, is_reproducible_and_complete) {
  const auto pdf = sheet_pdf(small_sheet());
  ASSERT_TRUE(pdf) << pdf.error().message;
  EXPECT_TRUE(pdf->starts_with("%PDF-"));
  EXPECT_NE(pdf->find("%%EOF"), std::string::npos);
  EXPECT_EQ(*sheet_pdf(small_sheet()), *pdf);
}

TEST(SheetPdf, long_tables_continue_on_the_next_page) {
  Sheet sheet = small_sheet();
  const int before = pages_of(*sheet_pdf(sheet));
  for (int n = 0; n < 150; ++n)
    sheet.tables[0].rows.push_back({"row " + std::to_string(n), std::string(40, 'w')});
  const auto pdf = sheet_pdf(sheet);
  ASSERT_TRUE(pdf);
  EXPECT_GE(pages_of(*pdf), before + 2);
}

TEST(SheetPdf, refuses_bad_pictures_and_counts) {
  Sheet sheet = small_sheet();
  sheet.pictures[0].png.resize(20);
  EXPECT_EQ(sheet_pdf(sheet).error().code, ErrorCode::kFileCorrupt);
  sheet.pictures[0].png = "not a picture";
  EXPECT_EQ(sheet_pdf(sheet).error().code, ErrorCode::kFileCorrupt);
  sheet = small_sheet();
  sheet.pictures_per_row = 0;
  EXPECT_EQ(sheet_pdf(sheet).error().code, ErrorCode::kInvalidArgument);
  EXPECT_TRUE(sheet_pdf({}));
}

TEST(DrawCephalogram, thick_parts_are_bright_and_tracings_are_drawn) {
  CephalogramDrawing drawing;
  drawing.columns = 200;
  drawing.rows = 100;
  drawing.pixel_mm = 0.5;
  drawing.water_mm.assign(20000, 0.0);
  for (int row = 0; row < 100; ++row)
    for (int column = 100; column < 200; ++column)
      drawing.water_mm[std::size_t(200 * row + column)] = 80.0;
  const Rgb red{1.0, 0.0, 0.0};
  drawing.tracings = {{"bone", red, {{{10.0, 50.5}, {90.0, 50.5}}}}};
  drawing.points = {{"N", red, {50.0, 20.0}}};
  const auto picture = draw_cephalogram(drawing);
  ASSERT_TRUE(picture) << picture.error().message;
  EXPECT_EQ(picture->width, 200);
  EXPECT_GT(picture->height, 100);
  // The panel begins below the caption: find the row of the tracing.
  int traced = -1;
  for (int row = 0; row < picture->height && traced < 0; ++row) {
    const auto* const p = picture->pixel(70, row);
    if (p[0] > 150 && p[1] < 100 && p[2] < 100) traced = row;
  }
  ASSERT_GT(traced, 0);
  EXPECT_EQ(picture->pixel(150, traced)[0], 255);
  EXPECT_EQ(picture->pixel(20, traced - 20)[0], 0);

  drawing.water_mm.pop_back();
  EXPECT_EQ(draw_cephalogram(drawing).error().code, ErrorCode::kInvalidArgument);
  drawing.water_mm.clear();  // Tracings alone.
  EXPECT_TRUE(draw_cephalogram(drawing));
}

}  // namespace
}  // namespace lefort::report
