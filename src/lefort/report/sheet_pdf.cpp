#include <lefort/core/version.h>
#include <lefort/report/internal/plain_text.h>
#include <lefort/report/sheet_pdf.h>

#include <cairo-pdf.h>
#include <cairo.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <memory>
#include <utility>

namespace lefort::report {
namespace {

// A4 in points.
constexpr double kWidth_pt = 595.28, kHeight_pt = 841.89, kMargin_pt = 42.0;
constexpr double kText_pt = 8.5, kLine_pt = 12.0, kTitle_pt = 15.0;
constexpr double kColumn_pt = kWidth_pt - 2.0 * kMargin_pt;

struct FreeSurface {
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
};
struct FreeContext {
  void operator()(cairo_t* cairo) const { cairo_destroy(cairo); }
};
using Surface = std::unique_ptr<cairo_surface_t, FreeSurface>;
using Context = std::unique_ptr<cairo_t, FreeContext>;

cairo_status_t append(void* text, const unsigned char* bytes, unsigned int count) {
  static_cast<std::string*>(text)->append(reinterpret_cast<const char*>(bytes), count);
  return CAIRO_STATUS_SUCCESS;
}

struct PngReader {
  const std::string& bytes;
  std::size_t next = 0;
};

cairo_status_t read_png(void* reader, unsigned char* to, unsigned int count) {
  auto& png = *static_cast<PngReader*>(reader);
  if (png.bytes.size() - png.next < count) return CAIRO_STATUS_READ_ERROR;
  std::memcpy(to, png.bytes.data() + png.next, count);
  png.next += count;
  return CAIRO_STATUS_SUCCESS;
}

Result<Surface> decoded(const std::string& png) {
  PngReader reader{png};
  Surface surface(cairo_image_surface_create_from_png_stream(read_png, &reader));
  if (cairo_surface_status(surface.get()) != CAIRO_STATUS_SUCCESS)
    return fail(ErrorCode::kFileCorrupt, "a picture of the sheet is no PNG");
  return surface;
}

/// Writes from top to bottom, and begins a page when one is full.
class Pages {
 public:
  explicit Pages(std::string& pdf)
      : surface_(cairo_pdf_surface_create_for_stream(append, &pdf, kWidth_pt, kHeight_pt)) {
    cairo_pdf_surface_set_metadata(surface_.get(), CAIRO_PDF_METADATA_CREATE_DATE,
                                   "2000-01-01T00:00:00Z");
    context_.reset(cairo_create(surface_.get()));
  }

  [[nodiscard]] double width_of(const std::string& text, double size_pt, bool bold) {
    select(size_pt, bold);
    cairo_text_extents_t extents;
    cairo_text_extents(context_.get(), plain_text(text).c_str(), &extents);
    return extents.x_advance;
  }
  void write(double x, const std::string& text, double size_pt, bool bold = false) {
    select(size_pt, bold);
    cairo_move_to(context_.get(), x, y_);
    cairo_show_text(context_.get(), plain_text(text).c_str());
  }
  void advance(double height_pt) { y_ += height_pt; }
  void rule() {
    cairo_set_line_width(context_.get(), 0.5);
    cairo_move_to(context_.get(), kMargin_pt, y_ + 3.0);
    cairo_line_to(context_.get(), kWidth_pt - kMargin_pt, y_ + 3.0);
    cairo_stroke(context_.get());
  }
  /// Begins a page unless `height_pt` fits below. \returns whether a page was begun.
  bool keep(double height_pt) {
    if (y_ + height_pt <= kHeight_pt - kMargin_pt - kLine_pt) return false;
    end_page();
    y_ = kMargin_pt + kLine_pt;
    return true;
  }
  void place(cairo_surface_t* picture, double x, double width_pt) {
    const double scale = width_pt / double(cairo_image_surface_get_width(picture));
    cairo_save(context_.get());
    cairo_translate(context_.get(), x, y_);
    cairo_scale(context_.get(), scale, scale);
    cairo_set_source_surface(context_.get(), picture, 0.0, 0.0);
    cairo_paint(context_.get());
    cairo_restore(context_.get());
  }
  Result<void> finish() {
    end_page();
    cairo_surface_finish(surface_.get());
    if (cairo_surface_status(surface_.get()) != CAIRO_STATUS_SUCCESS)
      return fail(ErrorCode::kInvalidArgument, "the PDF could not be written");
    return {};
  }

 private:
  void select(double size_pt, bool bold) {
    cairo_select_font_face(context_.get(), "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                           bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(context_.get(), size_pt);
    cairo_set_source_rgb(context_.get(), 0.0, 0.0, 0.0);
  }
  void end_page() {
    y_ = kHeight_pt - kMargin_pt;
    write(kMargin_pt, kNotForClinicalUse, 7.5, true);
    write(kWidth_pt - kMargin_pt - 40.0, fmt::format("page {}", ++pages_), 7.5);
    cairo_show_page(context_.get());
  }

  Surface surface_;
  Context context_;
  double y_ = kMargin_pt + kTitle_pt;
  int pages_ = 0;
};

void write_wrapped(Pages& pages, const std::string& text) {
  constexpr std::size_t kMaxWord = 70;  // Bytes; longer words are divided.
  std::string line;
  const auto flush = [&] {
    pages.keep(kLine_pt);
    pages.write(kMargin_pt, line, kText_pt);
    pages.advance(kLine_pt);
    line.clear();
  };
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    const std::string word = text.substr(at, std::min(end - at, kMaxWord));
    std::string longer = line;
    if (!longer.empty()) longer += ' ';
    longer += word;
    if (!line.empty() && pages.width_of(longer, kText_pt, false) > kColumn_pt) {
      flush();
      line = word;
    } else {
      line = longer;
    }
    at += word.size() < end - at ? word.size() : end - at + 1;
  }
  flush();
}

/// The size at which a title fits into one line.
double title_size(Pages& pages, const std::string& title) {
  const double width_pt = pages.width_of(title, kTitle_pt, true);
  return width_pt > kColumn_pt ? kTitle_pt * kColumn_pt / width_pt : kTitle_pt;
}

Result<void> write_pictures(Pages& pages, const Sheet& sheet) {
  const auto per_row = std::size_t(sheet.pictures_per_row);
  constexpr double kGap_pt = 10.0;
  const double width_pt = (kColumn_pt - kGap_pt * double(per_row - 1)) / double(per_row);
  for (std::size_t first = 0; first < sheet.pictures.size(); first += per_row) {
    const std::size_t end = std::min(first + per_row, sheet.pictures.size());
    std::vector<Surface> row;
    double height_pt = 0.0;
    for (std::size_t n = first; n < end; ++n) {
      LEFORT_TRY(Surface picture, decoded(sheet.pictures[n].png));
      height_pt =
          std::max(height_pt, width_pt * double(cairo_image_surface_get_height(picture.get())) /
                                  double(cairo_image_surface_get_width(picture.get())));
      row.push_back(std::move(picture));
    }
    // A row that is taller than the page is made smaller.
    constexpr double kMaxHeight_pt = kHeight_pt - 2.0 * kMargin_pt - 5.0 * kLine_pt;
    const double shrink = std::min(1.0, kMaxHeight_pt / std::max(height_pt, 1.0));
    height_pt *= shrink;
    pages.keep(height_pt + 2.0 * kLine_pt);
    for (std::size_t n = first; n < end; ++n)
      pages.write(kMargin_pt + double(n - first) * (width_pt + kGap_pt), sheet.pictures[n].title,
                  kText_pt);
    pages.advance(0.5 * kLine_pt);
    for (std::size_t n = 0; n < row.size(); ++n)
      pages.place(row[n].get(), kMargin_pt + double(n) * (width_pt + kGap_pt), shrink * width_pt);
    pages.advance(height_pt + 1.5 * kLine_pt);
  }
  return {};
}

/// Left edges of the columns. Text that is too wide makes the font of the table smaller.
struct Columns {
  std::vector<double> left_pt;
  double size_pt = kText_pt;
};

Columns columns_of(Pages& pages, const ReportTable& table) {
  constexpr double kGap_pt = 9.0, kMinSize_pt = 5.0;
  std::vector<double> widths(table.heads.size(), 0.0);
  const auto widen = [&](const std::vector<std::string>& cells, bool bold) {
    for (std::size_t c = 0; c < std::min(cells.size(), widths.size()); ++c)
      widths[c] = std::max(widths[c], pages.width_of(cells[c], kText_pt, bold) + kGap_pt);
  };
  widen(table.heads, true);
  for (const auto& row : table.rows) widen(row, false);
  double total_pt = 0.0;
  for (const double width : widths) total_pt += width;
  Columns columns;
  const double scale = std::min(1.0, kColumn_pt / std::max(total_pt, 1.0));
  columns.size_pt = std::max(kMinSize_pt, kText_pt * scale);
  double left_pt = kMargin_pt;
  for (const double width : widths) {
    columns.left_pt.push_back(left_pt);
    left_pt += width * scale;
  }
  return columns;
}

void write_table(Pages& pages, const ReportTable& table) {
  constexpr double kFewRows = 4.0;
  const Columns columns = columns_of(pages, table);
  const auto write_row = [&](const std::vector<std::string>& cells, bool bold) {
    for (std::size_t c = 0; c < std::min(cells.size(), columns.left_pt.size()); ++c)
      pages.write(columns.left_pt[c], cells[c], columns.size_pt, bold);
    if (bold) pages.rule();
    pages.advance(kLine_pt);
  };
  pages.keep(kLine_pt * kFewRows);
  pages.write(kMargin_pt, table.title, kText_pt + 1.5, true);
  pages.advance(1.4 * kLine_pt);
  write_row(table.heads, true);
  for (const auto& row : table.rows) {
    if (pages.keep(kLine_pt)) write_row(table.heads, true);
    write_row(row, false);
  }
  pages.advance(kLine_pt);
}

}  // namespace

Result<std::string> sheet_pdf(const Sheet& sheet) {
  if (sheet.pictures_per_row < 1 || sheet.pictures_per_row > 4)
    return fail(ErrorCode::kInvalidArgument, "a row of a sheet has 1 to 4 pictures");
  std::string pdf;
  Pages pages(pdf);
  pages.write(kMargin_pt, sheet.title, title_size(pages, sheet.title), true);
  pages.advance(1.5 * kLine_pt);
  for (const std::string& line : sheet.lines) write_wrapped(pages, line);
  pages.advance(0.7 * kLine_pt);
  LEFORT_TRY_VOID(write_pictures(pages, sheet));
  for (const ReportTable& table : sheet.tables) write_table(pages, table);
  LEFORT_TRY_VOID(pages.finish());
  return pdf;
}

}  // namespace lefort::report
