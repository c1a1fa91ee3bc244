#include <lefort/anatomy/extract_surface.h>
#include <lefort/anatomy/tissue_levels.h>
#include <lefort/anatomy/tissue_volumes.h>
#include <lefort/geometry/rigid_path.h>
#include <lefort/io/read_vtu.h>
#include <lefort/io/segmentation_file.h>
#include <lefort/io/sha256.h>
#include <lefort/io/vtu.h>
#include <lefort/pipeline/cache/stage_keys.h>
#include <lefort/pipeline/prepare/cached_field.h>
#include <lefort/pipeline/prepare/load_head.h>
#include <lefort/pipeline/prepare/prepare_case.h>
#include <lefort/plan/bone_bodies.h>
#include <lefort/predict/assign_regions.h>
#include <lefort/predict/mesh_tissue.h>
#include <lefort/predict/tissue_boundary.h>

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;

Result<mesh::VolumeMesh> find_tissue_mesh(const predict::TissueDomain& domain,
                                          const geometry::TriangleMesh& skin_L,
                                          const geometry::TriangleMesh& moved_L,
                                          const geometry::TriangleMesh& remainder_L,
                                          const predict::TissueOptions& options, double capture_mm,
                                          const std::string& key, const StageCache& cache,
                                          Progress& progress) {
  progress.begin_stage("mesh the soft tissue");
  return cache.get(
      "tissue.vtu", key, progress, [](const fs::path& path) { return io::read_vtu(path); },
      [&] {
        return options.skin ? predict::mesh_tissue_and_skin(domain, skin_L, moved_L, remainder_L,
                                                            options, capture_mm, progress)
                            : predict::mesh_tissue(domain, moved_L, options, progress);
      },
      [](const fs::path& path, const mesh::VolumeMesh& made) { return io::write_vtu(path, made); });
}

Result<std::vector<predict::MovedSegment>> find_segments(const plan::CutSegments& cut,
                                                         const field::DistanceFieldOptions& options,
                                                         const StageCache& cache,
                                                         Progress& progress) {
  std::vector<predict::MovedSegment> segments;
  for (const geometry::TriangleMesh& segment_L : cut.segments_L) {
    LEFORT_TRY(auto field, find_field("segment", segment_L, options, cache, progress));
    segments.push_back({segment_L, std::move(field)});
  }
  return segments;
}

/// \param field_options  of the segments' fields.
Result<std::vector<predict::BoneOverlapAtFraction>> find_overlaps(
    const plan::CutSegments& cut, const std::vector<geometry::RigidPath>& paths,
    const std::vector<predict::MovedSegment>& segments, const io::PlanFile& plan,
    field::DistanceFieldOptions field_options, const StageCache& cache, Progress& progress) {
  field_options.smooth = false;
  LEFORT_TRY(const auto stationary_field,
             find_field("remainder", cut.remainder_L, field_options, cache, progress));
  progress.begin_stage("bone against bone");
  if (!stationary_field->frame().closed)
    progress.note(
        "warning: the still bone is an open surface, so that the segment may overlap it unseen");
  std::vector<predict::MovingBone> bones;
  const auto add = [&](std::string name, const geometry::TriangleMesh& surface_B,
                       const geometry::RigidPath* path,
                       const std::shared_ptr<const field::DistanceField>& field) -> Result<void> {
    LEFORT_TRY(auto distance_query_B,
               contact::field_distance_query(field, contact::DetectionMethod::kTrilinear));
    bones.push_back(
        {std::move(name), &surface_B, path, std::move(distance_query_B), field->cell_mm()});
    return {};
  };
  for (std::size_t k = 0; k < segments.size(); ++k)
    LEFORT_TRY_VOID(add(paths[k].segment, segments[k].surface_B, &paths[k], segments[k].field_B));
  LEFORT_TRY_VOID(add(predict::kRemainder, cut.remainder_L, nullptr, stationary_field));
  std::vector<predict::BoneOverlapAtFraction> overlaps;
  const int steps = geometry::steps_of(paths);
  for (int step = 1; step <= steps; ++step)
    for (std::size_t a = 0; a < segments.size(); ++a)
      for (std::size_t b = a + 1; b < bones.size(); ++b) {
        overlaps.push_back(predict::overlap_at(double(step) / steps, bones[a], bones[b]));
        if (bones[b].path == nullptr) overlaps.back().overlap.depth_of_second_mm = {};
      }
  const auto worst = std::max_element(
      overlaps.begin(), overlaps.end(),
      [](const auto& a, const auto& b) { return a.overlap.deepest_mm < b.overlap.deepest_mm; });
  if (worst != overlaps.end() && worst->overlap.overlaps())
    progress.note("warning: " + describe(*worst, plan));
  return overlaps;
}

/// Whether the labels have what the plan has a material for.
Result<void> check_muscle(const predict::TissueOptions& options, const anatomy::LabelMap& labels) {
  const bool is_there = std::find(labels.values.begin(), labels.values.end(),
                                  anatomy::Tissue::kMuscle) != labels.values.end();
  if (!options.muscle || is_there) return {};
  return fail(ErrorCode::kPlanInvalid,
              "tissue.muscle: no voxel of the labels is muscle; paint a segment called muscle and "
              "name its file as segmentation.labels");
}

/// Muscle first: what somebody painted wins over the rule.
mesh::VolumeMesh assign_regions(mesh::VolumeMesh tissue, const predict::TissueOptions& options,
                                const anatomy::LabelMap& labels, Progress& progress) {
  if (!options.muscle && !options.mucosa) return tissue;
  if (options.muscle) tissue = predict::assign_muscle(std::move(tissue), labels);
  if (options.mucosa)
    tissue = predict::assign_mucosa(std::move(tissue), labels, options.mucosa->thickness_mm);
  progress.note(predict::describe_regions(tissue, options));
  for (const auto& [name, size] : predict::regions_and_sizes(tissue, options))
    if (size.elements == 0)
      progress.note(
          fmt::format("warning: tissue.{} changes nothing: no element is {}", name, name));
  return tissue;
}

}  // namespace

std::string describe(const predict::BoneOverlapAtFraction& pair, const io::PlanFile& plan) {
  const contact::BoneOverlap& overlap = pair.overlap;
  const auto in_words = [&](const std::string& bone) {
    if (bone == predict::kRemainder) return std::string("still bone");
    return plan.segments.size() == 1 ? std::string("the segment") : "segment " + bone;
  };
  return fmt::format(
      "the path drives bone through bone: at {:.1f} % {} and {} share {:.2f} ml, "
      "{}{:.2f} mm deep at ({:.1f}, {:.1f}, {:.1f}) mm",
      100.0 * pair.path_fraction, in_words(pair.first), in_words(pair.second),
      overlap.volume_mm3 * 1e-3, overlap.depth_is_lower_bound ? "more than " : "up to ",
      overlap.deepest_mm, overlap.deepest_L.x(), overlap.deepest_L.y(), overlap.deepest_L.z());
}

Result<PreparedCase> prepare_case(io::PlanFile plan, const std::string& plan_sha256,
                                  const fs::path& ct_path, const StageCache& cache,
                                  Progress& progress) {
  const std::vector<geometry::RigidPath> paths = plan::paths_of(plan.segments);
  LEFORT_TRY(const ScannedHead head, scan_head(plan, ct_path, cache, progress));
  const io::ImportedVolume& scan = head.scan;
  const image::CtVolume& ct = scan.ct;
  const std::string& ct_sha256 = head.ct_sha256;
  const anatomy::LabelMap& labels = head.labels;
  const anatomy::LevelOptions& levels = head.levels;
  LEFORT_TRY_VOID(check_muscle(plan.tissue, labels));
  std::optional<predict::BoundaryLabelMap> painted;
  if (plan.boundary_labels) {
    LEFORT_TRY(painted, io::read_boundary_labels(*plan.boundary_labels, ct.grid, progress));
  }
  LEFORT_TRY(geometry::TriangleMesh skin_L,
             anatomy::extract_isosurface(anatomy::skin_level(ct, labels, levels), {}, progress));

  progress.begin_stage("cut the bone");
  LEFORT_TRY(plan::CutSegments cut, plan::cut_segments(head.skull_L, plan.segments, progress));
  geometry::TriangleMesh moved_L;  // All segments.
  for (const geometry::TriangleMesh& segment_L : cut.segments_L) plan::append(moved_L, segment_L);
  for (const plan::OsteotomyResult& bones : cut.cuts) note_fragments(bones, progress);
  field::DistanceFieldOptions field_options = plan.field;
  field_options.smooth = plan.contact.detection == contact::DetectionMethod::kSmooth;
  LEFORT_TRY(std::vector<predict::MovedSegment> segments,
             find_segments(cut, field_options, cache, progress));
  LEFORT_TRY_VOID(predict::check_reach(paths, segments, plan.contact.detection,
                                       plan.boundary));  // Before the costly mesh.

  LEFORT_TRY(std::vector<predict::BoneOverlapAtFraction> overlaps,
             find_overlaps(cut, paths, segments, plan, field_options, cache, progress));

  const predict::TissueDomain domain = predict::make_tissue_domain(
      anatomy::soft_tissue_level(ct, labels, levels, progress), ct.grid, moved_L, plan.tissue);
  const std::string key = tissue_key(ct_sha256, labels, levels, moved_L, cut.remainder_L,
                                     plan.tissue, plan.boundary.capture_mm);
  LEFORT_TRY(mesh::VolumeMesh tissue,
             find_tissue_mesh(domain, skin_L, moved_L, cut.remainder_L, plan.tissue,
                              plan.boundary.capture_mm, key, cache, progress));
  tissue = assign_regions(std::move(tissue), plan.tissue, labels, progress);
  progress.begin_stage("find boundaries");
  tissue =
      predict::find_tissue_boundary(std::move(tissue), domain, labels, skin_L, moved_L,
                                    cut.remainder_L, plan.boundary, painted ? &*painted : nullptr);
  progress.note(predict::describe_boundary(tissue, plan.boundary));
  if (painted && predict::all_painted_nodes(tissue).empty())
    progress.note(
        "warning: boundary.labels decides nothing: no node of the tissue's boundary lies "
        "where it is painted");
  mesh::MeshQuality quality = mesh::measure_quality(tissue);
  std::optional<mesh::LayerThickness> skin_layer;
  if (const auto& skin = plan.tissue.skin) {
    skin_layer = mesh::layer_thickness_statistics(tissue, predict::regions::kSkin,
                                                  tissue.face_sets.at(predict::sets::kSkin),
                                                  skin->layers, skin->thickness_mm);
    progress.note(
        fmt::format("skin: {:.2f} mm thick on average, wedges under {:.1f} % of {:.0f} mm2; {} "
                    "elements, smallest scaled Jacobian {:.3f}",
                    skin_layer->mean_mm, 100.0 * skin_layer->covered_fraction, skin_layer->area_mm2,
                    quality.elements, quality.min_scaled_jacobian));
  }
  predict::FaceModel model{std::move(tissue), std::move(segments)};
  if (model.tissue.face_sets.contains(predict::sets::kStationaryContact)) {
    LEFORT_TRY(auto stationary_field,
               find_field("remainder", cut.remainder_L, field_options, cache, progress));
    model.stationary_bone = predict::MovedSegment{cut.remainder_L, std::move(stationary_field)};
  }
  Provenance provenance{.plan_sha256 = plan_sha256,
                        .ct_sha256 = ct_sha256,
                        .ct_kind = scan.source_kind,
                        .labels_sha256 = io::Sha256().add(labels).hex(),
                        .labels_source = plan.labels ? "file" : "segmented",
                        .warnings = scan.warnings};
  return PreparedCase{std::move(plan),
                      std::move(provenance),
                      ct.grid,
                      anatomy::tissue_volumes_ml(labels),
                      std::move(skin_L),
                      std::move(cut),
                      std::move(model),
                      std::move(quality),
                      std::move(skin_layer),
                      std::move(overlaps)};
}

}  // namespace lefort::pipeline
