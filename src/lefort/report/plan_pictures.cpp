#include <lefort/geometry/mesh_properties.h>
#include <lefort/geometry/rigid_path.h>
#include <lefort/geometry/transform_mesh.h>
#include <lefort/report/annotate.h>
#include <lefort/report/picture.h>
#include <lefort/report/plan_pictures.h>
#include <lefort/report/render_surfaces.h>
#include <lefort/report/segment_colors.h>
#include <lefort/report/view.h>

#include <algorithm>
#include <array>
#include <limits>

namespace lefort::report {
namespace {

constexpr PictureSize kPlanPictureSize{.width = 900, .height = 900, .supersampling = 2};
constexpr std::array<StandardView, 4> kPlanViews{
    StandardView::kFront, StandardView::kRightThreeQuarter, StandardView::kRightProfile,
    StandardView::kLeftProfile};

/// Fragments smaller than every segment, slightly widened: they lie on the surface of their owners.
/// A larger one is a bone of its own, as the mandible behind a cut of the maxilla.
std::vector<geometry::TriangleMesh> fragments_of(const plan::CutSegments& cut) {
  constexpr double kWider = 1.02;
  double min_segment_mm3 = std::numeric_limits<double>::infinity();
  for (const double volume_mm3 : cut.volumes_mm3)
    min_segment_mm3 = std::min(min_segment_mm3, volume_mm3);
  std::vector<geometry::TriangleMesh> fragments_L;
  for (const plan::OsteotomyResult& bones : cut.cuts)
    for (const plan::Fragment& one : bones.fragments) {
      if (one.volume_mm3 >= min_segment_mm3) continue;
      fragments_L.push_back(one.surface_L);
      for (Vec3& v : fragments_L.back().vertices) v = one.center_L + kWider * (v - one.center_L);
    }
  return fragments_L;
}

}  // namespace

Result<std::vector<PlanPicture>> draw_plan(const plan::CutSegments& cut,
                                           std::span<const plan::PlannedSegment> planned,
                                           Progress& progress) {
  Box3 focus_L = geometry::bounding_box(cut.remainder_L);
  std::vector<geometry::TriangleMesh> ends_L;
  for (std::size_t k = 0; k < planned.size(); ++k) {
    ends_L.push_back(
        geometry::transformed(cut.segments_L[k], geometry::pose_at(planned[k].path, 1.0)));
    focus_L.extend(geometry::bounding_box(cut.segments_L[k]));
    focus_L.extend(geometry::bounding_box(ends_L[k]));
  }
  const std::vector<geometry::TriangleMesh> fragments_L = fragments_of(cut);
  std::vector<PlanPicture> pictures;
  for (const bool is_after : {false, true}) {
    std::vector<SurfaceLayer> layers{{.mesh_L = &cut.remainder_L, .color = kBoneColor}};
    for (std::size_t k = 0; k < planned.size(); ++k)
      layers.push_back({.mesh_L = is_after ? &ends_L[k] : &cut.segments_L[k],
                        .color = kSegmentColors[k % kSegmentColors.size()]});
    if (!is_after)
      for (const geometry::TriangleMesh& fragment_L : fragments_L)
        layers.push_back({.mesh_L = &fragment_L, .color = kFragmentColor});
    LEFORT_TRY(const SurfaceScene scene, SurfaceScene::build(layers, progress));
    for (const StandardView side : kPlanViews) {
      const View view =
          standard_view(side, focus_L, double(kPlanPictureSize.width) / kPlanPictureSize.height);
      LEFORT_TRY(const Picture raw, scene.render(view, kPlanPictureSize, progress));
      const std::string title = std::string(is_after ? "Planned" : "Cut") + ", " + name_of(side);
      LEFORT_TRY(const Picture picture, annotate(raw, {.caption = title, .view = view}));
      LEFORT_TRY(std::string png, encode_png(picture));
      std::string file =
          std::string(is_after ? "plan_after_" : "plan_cut_") + name_of(side) + ".png";
      std::replace_if(
          file.begin(), file.end(), [](char c) { return c == ' ' || c == '-'; }, '_');
      pictures.push_back({std::move(file), std::move(png)});
      progress.report(double(pictures.size()) / double(2 * kPlanViews.size()));
    }
  }
  return pictures;
}

}  // namespace lefort::report
