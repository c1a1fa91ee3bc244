#include <lefort/core/parallel.h>
#include <lefort/geometry/mesh_properties.h>
#include <lefort/geometry/transform_mesh.h>
#include <lefort/pipeline/predict/prediction_pictures.h>
#include <lefort/predict/embed_skin.h>
#include <lefort/report/annotate.h>
#include <lefort/report/picture.h>
#include <lefort/report/render_surfaces.h>
#include <lefort/report/segment_colors.h>
#include <lefort/report/view.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace lefort::pipeline {
namespace {

using report::StandardView;
using report::SurfaceScene;

constexpr report::PictureSize kSize{.width = 1000, .height = 900, .supersampling = 2};
constexpr report::Rgb kFirstSegment{0.36, 0.55, 0.80};  ///< Other segments as in pictures of plans.

/// One kind of picture, from several cameras.
struct Series {
  PictureKind kind;
  std::string file;
  std::string title;
  const report::SurfaceScene& scene;
  std::vector<StandardView> views;
  std::optional<report::ColorBar> color_bar;
};

std::string file_part(StandardView view) {
  std::string name = report::name_of(view);
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c == ' ' || c == '-'; }, '_');
  return name;
}

/// A round upper end for the color scale.
double scale_end_mm(std::span<const double> lengths_mm) {
  const double largest =
      lengths_mm.empty() ? 0.0 : *std::max_element(lengths_mm.begin(), lengths_mm.end());
  return std::max(1.0, std::ceil(largest));
}

/// Draws the series, then encodes all pictures at the same time.
Result<std::vector<PredictionPicture>> draw_all(std::span<const Series> all, const Box3& focus_L,
                                                Progress& progress) {
  std::vector<PredictionPicture> pictures;
  std::vector<report::Picture> drawn;
  for (const Series& series : all)
    for (const StandardView side : series.views) {
      const report::View view =
          report::standard_view(side, focus_L, double(kSize.width) / kSize.height);
      LEFORT_TRY(const report::Picture raw, series.scene.render(view, kSize, progress));
      const std::string title = series.title + ", " + report::name_of(side);
      LEFORT_TRY(drawn.emplace_back(), report::annotate(raw, {title, series.color_bar, view}));
      pictures.push_back({series.kind, series.file + "_" + file_part(side) + ".png", title, {}});
      progress.report(double(drawn.size()) / 10.0);
    }
  std::vector<Result<std::string>> encoded(drawn.size());
  parallel_for(
      Index(drawn.size()),
      [&](Index n) { encoded[std::size_t(n)] = report::encode_png(drawn[std::size_t(n)]); }, 1);
  for (std::size_t n = 0; n < drawn.size(); ++n) {
    LEFORT_TRY(pictures[n].png, std::move(encoded[n]));
  }
  return pictures;
}

}  // namespace

Result<std::vector<PredictionPicture>> draw_prediction(
    const PreparedCase& prepared, std::span<const Vec3> skin_displacement_mm,
    std::span<const predict::SegmentStep> segments, Progress& progress) {
  const geometry::TriangleMesh after_L = predict::displaced(prepared.skin_L, skin_displacement_mm);
  std::vector<geometry::TriangleMesh> moved_L;
  for (std::size_t k = 0; k < segments.size(); ++k)
    moved_L.push_back(geometry::transformed(prepared.cut.segments_L[k], segments[k].X_LB));
  std::vector<report::SurfaceLayer> bones{
      {.mesh_L = &prepared.cut.remainder_L, .color = report::kBoneColor}};
  for (std::size_t k = 0; k < moved_L.size(); ++k)
    bones.push_back({.mesh_L = &moved_L[k],
                     .color = k == 0 ? kFirstSegment
                                     : report::kSegmentColors[k % report::kSegmentColors.size()]});
  std::vector<double> lengths_mm;
  for (const Vec3& u : skin_displacement_mm) lengths_mm.push_back(u.norm());
  const report::ColorScale scale{report::ColorMap::kSequential, 0.0, scale_end_mm(lengths_mm)};

  const std::vector<StandardView> face_views{StandardView::kFront, StandardView::kRightThreeQuarter,
                                             StandardView::kRightProfile};
  const std::array<report::SurfaceLayer, 1> skin_before{{{.mesh_L = &prepared.skin_L}}},
      skin_after{{{.mesh_L = &after_L}}};
  LEFORT_TRY(const SurfaceScene before, SurfaceScene::build(skin_before, progress));
  LEFORT_TRY(const SurfaceScene after, SurfaceScene::build(skin_after, progress));
  LEFORT_TRY(const SurfaceScene displacement, after.recolored(0, lengths_mm, scale));
  LEFORT_TRY(const SurfaceScene bones_after, SurfaceScene::build(bones, progress));
  const std::vector<Series> all{
      {PictureKind::kBefore, "before", "Before", before, face_views, {}},
      {PictureKind::kAfter, "after", "Predicted", after, face_views, {}},
      {PictureKind::kDisplacement,
       "displacement",
       "Displacement of the skin",
       displacement,
       {StandardView::kFront, StandardView::kRightThreeQuarter},
       report::ColorBar{scale, "displacement", "mm"}},
      {PictureKind::kBones,
       "bones",
       "Bones at the end of the path",
       bones_after,
       {StandardView::kFront, StandardView::kRightThreeQuarter},
       {}},
  };

  Box3 focus_L = geometry::bounding_box(prepared.skin_L);
  focus_L.extend(geometry::bounding_box(after_L));
  return draw_all(all, focus_L, progress);
}

}  // namespace lefort::pipeline
