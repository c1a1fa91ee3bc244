#include <lefort/geometry/mesh_properties.h>
#include <lefort/report/annotate.h>
#include <lefort/report/compare_pictures.h>
#include <lefort/report/picture.h>
#include <lefort/report/render_surfaces.h>
#include <lefort/report/view.h>

#include <array>

namespace lefort::report {
namespace {

constexpr PictureSize kComparePictureSize{.width = 1000, .height = 900, .supersampling = 2};

struct NamedView {
  StandardView view;
  const char* file;
};
constexpr std::array<NamedView, 3> kCompareViews{{
    {StandardView::kFront, "difference_front.png"},
    {StandardView::kRightThreeQuarter, "difference_right_three_quarter.png"},
    {StandardView::kLeftThreeQuarter, "difference_left_three_quarter.png"},
}};

double scale_end_mm(double p95_mm) {
  for (const double end_mm : {1.0, 2.0, 5.0, 10.0})
    if (p95_mm <= end_mm) return end_mm;
  return 20.0;
}

}  // namespace

std::vector<std::string> compare_picture_names() {
  std::vector<std::string> names;
  for (const NamedView& one : kCompareViews) names.emplace_back(one.file);
  return names;
}

Result<std::vector<ComparePicture>> draw_difference(const geometry::TriangleMesh& face_L,
                                                    std::span<const double> signed_mm,
                                                    double p95_mm, Progress& progress) {
  const double end_mm = scale_end_mm(p95_mm);
  const ColorScale scale{ColorMap::kDiverging, -end_mm, end_mm};
  const std::vector<SurfaceLayer> layers{
      {.mesh_L = &face_L, .scalars = {signed_mm.begin(), signed_mm.end()}, .scale = scale}};
  LEFORT_TRY(const SurfaceScene scene, SurfaceScene::build(layers, progress));
  const Box3 focus_L = geometry::bounding_box(face_L);
  std::vector<ComparePicture> pictures;
  for (const auto& [side, file] : kCompareViews) {
    const View view = standard_view(side, focus_L,
                                    double(kComparePictureSize.width) / kComparePictureSize.height);
    LEFORT_TRY(const Picture raw, scene.render(view, kComparePictureSize, progress));
    LEFORT_TRY(const Picture picture,
               annotate(raw, {.caption = std::string("Difference, ") + name_of(side),
                              .color_bar = ColorBar{scale, "outside (+), inside (-)", "mm"},
                              .view = view}));
    LEFORT_TRY(std::string png, encode_png(picture));
    pictures.push_back({file, std::move(png)});
    progress.report(double(pictures.size()) / double(kCompareViews.size()));
  }
  return pictures;
}

}  // namespace lefort::report
