#include <lefort/report/internal/plain_text.h>
#include <lefort/report/plot_band.h>

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string_view>

namespace lefort::report {
namespace {

using Vec2 = Eigen::Vector2d;

constexpr double kBandWidth = 720.0, kBandHeight = 760.0, kBandRim = 24.0, kBandLegend = 40.0;

bool is_finite(const BandPiece& piece) {
  for (const auto* ends : {&piece.low, &piece.middle, &piece.high, &piece.before})
    for (const Vec2& end : *ends)
      if (!end.allFinite()) return false;
  return true;
}

/// Fits all pieces into the drawing.
class BandFrame {
 public:
  explicit BandFrame(const std::vector<BandPiece>& pieces) {
    Eigen::AlignedBox2d box;
    for (const BandPiece& piece : pieces)
      for (const auto* ends : {&piece.low, &piece.high, &piece.before})
        for (const Vec2& end : *ends) box.extend(end);
    if (box.isEmpty()) box.extend(Vec2(0.0, 0.0));
    const Vec2 size = box.sizes().cwiseMax(1.0);
    scale_ = std::min((kBandWidth - 2.0 * kBandRim) / size.x(),
                      (kBandHeight - 2.0 * kBandRim) / size.y());
    center_ = box.center();
  }
  [[nodiscard]] Vec2 at(const Vec2& p) const {
    return {0.5 * kBandWidth + scale_ * (p.x() - center_.x()),
            kBandLegend + 0.5 * kBandHeight - scale_ * (p.y() - center_.y())};
  }
  [[nodiscard]] double scale() const { return scale_; }

 private:
  double scale_ = 1.0;
  Vec2 center_ = Vec2::Zero();
};

std::string stroke_path(const std::vector<BandPiece>& pieces, const BandFrame& frame,
                        std::array<Vec2, 2> BandPiece::*ends, std::string_view style) {
  std::string path;
  for (const BandPiece& piece : pieces) {
    const Vec2 a = frame.at((piece.*ends)[0]), b = frame.at((piece.*ends)[1]);
    path += fmt::format("M{:.2f} {:.2f}L{:.2f} {:.2f}", a.x(), a.y(), b.x(), b.y());
  }
  return fmt::format("<path d='{}' style='fill:none;stroke-linecap:round;{}'/>\n", path, style);
}

std::string fill_band(const std::vector<BandPiece>& pieces, const BandFrame& frame) {
  std::string path;
  for (const BandPiece& piece : pieces) {
    const Vec2 a = frame.at(piece.low[0]), b = frame.at(piece.low[1]);
    const Vec2 c = frame.at(piece.high[1]), d = frame.at(piece.high[0]);
    path += fmt::format("M{:.2f} {:.2f}L{:.2f} {:.2f}L{:.2f} {:.2f}L{:.2f} {:.2f}Z", a.x(), a.y(),
                        b.x(), b.y(), c.x(), c.y(), d.x(), d.y());
  }
  // The stroke closes the seams between pieces.
  return fmt::format(
      "<path d='{}' style='fill:#7fb3e6;stroke:#7fb3e6;stroke-width:0.6;stroke-linejoin:round'/>\n",
      path);
}

constexpr std::string_view kLowStyle = "stroke:var(--line-1, #1f5fa8);stroke-width:1";
constexpr std::string_view kMiddleStyle = "stroke:var(--line-2, #b3480f);stroke-width:1.8";
constexpr std::string_view kBeforeStyle =
    "stroke:var(--muted, #565e68);stroke-width:1.2;stroke-dasharray:4 3";

std::string band_legend(const BandPlot& plot) {
  std::string svg;
  double x = kBandRim;
  const auto add = [&](const std::string& name, std::string_view style) {
    svg += fmt::format("<line x1='{:.1f}' y1='20' x2='{:.1f}' y2='20' style='{}'/>\n", x, x + 24.0,
                       style);
    svg += fmt::format("<text x='{:.1f}' y='24.5' style='fill:var(--ink, #20252b)'>{}</text>\n",
                       x + 30.0, escaped(name));
    x += 52.0 + 7.0 * double(name.size());
  };
  add(plot.before_name, kBeforeStyle);
  add(plot.middle_name, kMiddleStyle);
  add(plot.low_name + " to " + plot.high_name, "stroke:#7fb3e6;stroke-width:10");
  return svg;
}

}  // namespace

std::string plot_band(const BandPlot& plot) {
  std::vector<BandPiece> pieces;
  std::copy_if(plot.pieces.begin(), plot.pieces.end(), std::back_inserter(pieces), is_finite);
  const BandFrame frame(pieces);
  std::string svg = fill_band(pieces, frame);
  svg += stroke_path(pieces, frame, &BandPiece::before, kBeforeStyle);
  svg += stroke_path(pieces, frame, &BandPiece::low, kLowStyle);
  svg += stroke_path(pieces, frame, &BandPiece::high, kLowStyle);
  svg += stroke_path(pieces, frame, &BandPiece::middle, kMiddleStyle);
  const double bar = 10.0 * frame.scale(), y = kBandLegend + kBandHeight - 8.0;
  svg += fmt::format(
      "<line x1='{0:.1f}' y1='{2:.1f}' x2='{1:.1f}' y2='{2:.1f}' "
      "style='stroke:var(--ink, #20252b);stroke-width:3'/>\n"
      "<text x='{0:.1f}' y='{3:.1f}' style='fill:var(--ink, #20252b)'>10 mm</text>\n",
      kBandRim, kBandRim + bar, y, y - 8.0);
  return fmt::format(
             "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {} {:.0f}' role='img' "
             "aria-label='{}' font-family='system-ui, sans-serif' font-size='13'>\n"
             "<title>{}</title>\n",
             kBandWidth, kBandLegend + kBandHeight, escaped(plot.title), escaped(plot.title)) +
         band_legend(plot) + svg + "</svg>\n";
}

}  // namespace lefort::report
