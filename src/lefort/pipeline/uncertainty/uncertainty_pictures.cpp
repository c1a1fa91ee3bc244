#include <lefort/geometry/mesh_properties.h>
#include <lefort/pipeline/uncertainty/uncertainty_results.h>
#include <lefort/predict/embed_skin.h>
#include <lefort/report/annotate.h>
#include <lefort/report/picture.h>
#include <lefort/report/render_surfaces.h>
#include <lefort/report/view.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace lefort::pipeline {
namespace {

constexpr report::PictureSize kUncertaintySize{.width = 1000, .height = 900, .supersampling = 2};
constexpr int kSide = 0, kDepth = 1, kHeight = 2;  // Axes of L.

/// Points of the skin at one end of a piece of the profile.
struct ProfilePoint {
  Eigen::Vector2d low, middle, high, before;
};

}  // namespace

std::vector<double> on_skin(const UncertainCase& face, const std::vector<double>& values,
                            double elsewhere) {
  std::vector<double> all(face.skin().skin_L.vertices.size(), elsewhere);
  for (std::size_t v = 0; v < values.size(); ++v)
    all[std::size_t(face.skin().vertices[v])] = values[v];
  return all;
}

std::vector<Vec3> median_skin_mm(const UncertainCase& face, const FaceStatistics& statistics) {
  const SampledSkin& skin = face.skin();
  std::vector<Vec3> displacement_mm = skin.nominal_mm;
  for (std::size_t k = 0; k < skin.vertices.size(); ++k) {
    const auto v = std::size_t(skin.vertices[k]);
    const double along = displacement_mm[v].dot(skin.normals_L[v]);
    displacement_mm[v] += (statistics.band.quantiles[1][k] - along) * skin.normals_L[v];
  }
  return displacement_mm;
}

report::BandPlot profile_plot(const UncertainCase& face, const FaceStatistics& statistics) {
  const SampledSkin& skin = face.skin();
  const std::vector<Vec3> median_mm = median_skin_mm(face, statistics);
  const geometry::TriangleMesh median_L = predict::displaced(skin.skin_L, median_mm);
  std::array<std::vector<double>, 2> offset_mm;  // From the median: P5, P95.
  for (const std::size_t end : {std::size_t(0), std::size_t(1)}) {
    std::vector<double> offsets(skin.vertices.size());
    for (std::size_t k = 0; k < offsets.size(); ++k)
      offsets[k] = statistics.band.quantiles[2 * end][k] - statistics.band.quantiles[1][k];
    offset_mm[end] = on_skin(face, offsets, 0.0);
  }
  Vec3 tip_L = Vec3::Constant(std::numeric_limits<double>::infinity());
  for (const std::int32_t v : skin.vertices)
    if (median_L.vertices[std::size_t(v)][kDepth] < tip_L[kDepth])
      tip_L = median_L.vertices[std::size_t(v)];
  const auto in_plane = [](const Vec3& p_L) {
    return Eigen::Vector2d(-p_L[kDepth], p_L[kHeight]);  // Anterior to the right.
  };
  report::BandPlot plot{.title = "Profile in the sagittal plane through the most anterior point",
                        .low_name = "P5",
                        .middle_name = "median",
                        .high_name = "P95",
                        .before_name = "before"};
  std::vector<char> is_sampled(skin.skin_L.vertices.size(), 0);
  for (const std::int32_t v : skin.vertices) is_sampled[std::size_t(v)] = 1;
  for (const auto& triangle : median_L.triangles) {
    std::vector<ProfilePoint> ends;
    for (std::size_t c = 0; c < 3; ++c) {
      const auto a = std::size_t(triangle[c]), b = std::size_t(triangle[(c + 1) % 3]);
      const Vec3 &p = median_L.vertices[a], &q = median_L.vertices[b];
      if ((p[kSide] >= tip_L[kSide]) == (q[kSide] >= tip_L[kSide])) continue;
      if (is_sampled[a] == 0 || is_sampled[b] == 0) continue;
      const double t = (tip_L[kSide] - p[kSide]) / (q[kSide] - p[kSide]);
      const auto mix = [&](const Vec3& x, const Vec3& y) { return Vec3((1.0 - t) * x + t * y); };
      const Vec3 middle = mix(p, q), normal = mix(skin.normals_L[a], skin.normals_L[b]);
      const auto moved = [&](const std::vector<double>& offset) {
        return in_plane(middle + ((1.0 - t) * offset[a] + t * offset[b]) * normal);
      };
      ends.push_back({moved(offset_mm[0]), in_plane(middle), moved(offset_mm[1]),
                      in_plane(mix(skin.skin_L.vertices[a], skin.skin_L.vertices[b]))});
    }
    if (ends.size() != 2) continue;
    plot.pieces.push_back({.low = {ends[0].low, ends[1].low},
                           .middle = {ends[0].middle, ends[1].middle},
                           .high = {ends[0].high, ends[1].high},
                           .before = {ends[0].before, ends[1].before}});
  }
  return plot;
}

Result<std::vector<UncertaintyPicture>> draw_uncertainty(const UncertainCase& face,
                                                         const FaceStatistics& statistics,
                                                         Progress& progress) {
  progress.begin_stage("draw");
  const geometry::TriangleMesh median_L =
      predict::displaced(face.skin().skin_L, median_skin_mm(face, statistics));
  std::vector<double> width(face.skin().vertices.size());
  for (std::size_t k = 0; k < width.size(); ++k)
    width[k] = statistics.band.quantiles[2][k] - statistics.band.quantiles[0][k];
  const double largest = width.empty() ? 1.0 : *std::max_element(width.begin(), width.end());
  const report::ColorScale scale{report::ColorMap::kSequential, 0.0,
                                 std::max(0.5, std::ceil(2.0 * largest) / 2.0)};
  const std::array<report::SurfaceLayer, 1> layers{
      {{.mesh_L = &median_L, .scalars = on_skin(face, width, 0.0), .scale = scale}}};
  LEFORT_TRY(const report::SurfaceScene scene, report::SurfaceScene::build(layers, progress));
  Box3 focus_L;
  for (const std::int32_t v : face.skin().vertices)
    focus_L.extend(median_L.vertices[std::size_t(v)]);
  if (focus_L.isEmpty()) focus_L = geometry::bounding_box(median_L);
  std::vector<UncertaintyPicture> pictures;
  for (const auto& [side, file] :
       {std::pair{report::StandardView::kFront, "band_front.png"},
        std::pair{report::StandardView::kRightThreeQuarter, "band_right.png"},
        std::pair{report::StandardView::kLeftThreeQuarter, "band_left.png"}}) {
    const report::View view = report::standard_view(
        side, focus_L, double(kUncertaintySize.width) / kUncertaintySize.height);
    LEFORT_TRY(const report::Picture raw, scene.render(view, kUncertaintySize, progress));
    const std::string title = std::string("Band width P95 - P5, ") + report::name_of(side);
    LEFORT_TRY(const report::Picture drawn,
               report::annotate(raw, {title, report::ColorBar{scale, "band width", "mm"}, view}));
    LEFORT_TRY(std::string png, report::encode_png(drawn));
    pictures.push_back({file, title, std::move(png)});
  }
  return pictures;
}

}  // namespace lefort::pipeline
