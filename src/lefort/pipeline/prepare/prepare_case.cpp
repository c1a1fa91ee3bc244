#include <lefort/anatomy/extract_surface.h>
#include <lefort/anatomy/tissue_levels.h>
#include <lefort/anatomy/tissue_volumes.h>
#include <lefort/geometry/rigid_path.h>
#include <lefort/io/read_vtu.h>
#include <lefort/io/segmentation_file.h>
#include <lefort/io/sha256.h>
#include <lefort/io/vtu.h>
#include <lefort/mesh/boundary_faces.h>
#include <lefort/mesh/element_faces.h>
#include <lefort/pipeline/cache/stage_keys.h>
#include <lefort/pipeline/prepare/cached_field.h>
#include <lefort/pipeline/prepare/find_obstacles.h>
#include <lefort/pipeline/prepare/load_head.h>
#include <lefort/pipeline/prepare/load_teeth.h>
#include <lefort/pipeline/prepare/prepare_case.h>
#include <lefort/plan/bone_bodies.h>
#include <lefort/plan/elevation_zone.h>
#include <lefort/predict/contact_field.h>
#include <lefort/predict/interface_supports.h>
#include <lefort/predict/mesh_tissue.h>
#include <lefort/predict/oral_fissure.h>
#include <lefort/predict/path_overlaps.h>
#include <lefort/predict/release_overlap.h>
#include <lefort/predict/second_order_tissue.h>
#include <lefort/predict/separate_lips.h>
#include <lefort/predict/tissue_boundary.h>
#include <lefort/predict/tissue_regions.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;

Result<mesh::VolumeMesh> find_tissue_mesh(const predict::TissueDomain& domain,
                                          const geometry::TriangleMesh& skin_L,
                                          const geometry::TriangleMesh& moved_L,
                                          const geometry::TriangleMesh& remainder_L,
                                          const predict::TissueOptions& options,
                                          double contact_snap_mm, const std::string& key,
                                          const StageCache& cache, Progress& progress) {
  progress.begin_stage("mesh the soft tissue");
  return cache.get(
      "tissue.vtu", key, progress, [](const fs::path& path) { return io::read_vtu(path); },
      [&] {
        return options.skin ? predict::mesh_tissue_and_skin(domain, skin_L, moved_L, remainder_L,
                                                            options, contact_snap_mm, progress)
                            : predict::mesh_tissue(domain, moved_L, options, progress);
      },
      [](const fs::path& path, const mesh::VolumeMesh& made) { return io::write_vtu(path, made); });
}

Result<std::vector<predict::ContactBone>> find_segments(const plan::CutSegments& cut,
                                                        const io::PlanFile& plan,
                                                        const StageCache& cache,
                                                        Progress& progress) {
  std::vector<predict::ContactBone> segments;
  for (const geometry::TriangleMesh& segment_L : cut.segments_L) {
    LEFORT_TRY(auto field, find_field("segment", segment_L, bone_field_options(plan, segment_L),
                                      cache, progress));
    segments.push_back({segment_L, std::move(field)});
  }
  return segments;
}

/// Bones of a plan after the osteotomies.
struct BonesAndFields {
  plan::CutSegments cut;
  geometry::TriangleMesh segments_L;  ///< All segments as one mesh.
  std::vector<predict::ContactBone> segments;
};

/// Checks the paths, too, because that takes seconds and meshing takes minutes.
Result<BonesAndFields> cut_bone(const io::PlanFile& plan, const ScannedHead& head,
                                const StageCache& cache, Progress& progress) {
  progress.begin_stage("cut the bone");
  BonesAndFields bones;
  LEFORT_TRY(bones.cut, plan::cut_segments(head.skull_L, head.mandible(), plan.segments, progress));
  for (const geometry::TriangleMesh& segment_L : bones.cut.segments_L)
    plan::append(bones.segments_L, segment_L);
  note_fragments(bones.cut, plan.segments, progress);
  for (std::size_t k = 0; k < plan.segments.size(); ++k)
    note_mixed_labels(head.labels, plan.segments[k].osteotomy.segment, bones.cut.segments_L[k],
                      progress);
  LEFORT_TRY(bones.segments, find_segments(bones.cut, plan, cache, progress));
  LEFORT_TRY_VOID(predict::check_query_range(plan::paths_of(plan.segments), bones.segments,
                                             plan.contact.detection, plan.boundary));
  return bones;
}

Result<std::vector<predict::BoneOverlapAtFraction>> find_overlaps(const BonesAndFields& prepared,
                                                                  const io::PlanFile& plan,
                                                                  const StageCache& cache,
                                                                  Progress& progress) {
  const geometry::TriangleMesh& remainder_L = prepared.cut.remainder_L;
  LEFORT_TRY(
      const auto stationary_field,
      find_field("remainder", remainder_L, bone_field_options(plan, remainder_L), cache, progress));
  progress.begin_stage("check bone overlap");
  if (!stationary_field->frame().closed)
    progress.note(
        "warning: the surface of the stationary bone is open, so overlap with it may not be "
        "found");
  const std::vector<geometry::RigidPath> paths = plan::paths_of(plan.segments);
  std::vector<predict::MovingBone> bones;
  for (std::size_t k = 0; k < paths.size(); ++k) {
    const predict::ContactBone& segment = prepared.segments[k];
    LEFORT_TRY(bones.emplace_back(), predict::make_moving_bone(paths[k].segment, segment.surface_B,
                                                               &paths[k], segment.field_B));
  }
  LEFORT_TRY(bones.emplace_back(), predict::make_moving_bone(predict::kRemainder, remainder_L,
                                                             nullptr, stationary_field));
  std::vector<predict::BoneOverlapAtFraction> overlaps =
      predict::path_overlaps(bones, geometry::steps_of(paths));
  if (const predict::BoneOverlapAtFraction* deepest = predict::find_deepest(overlaps))
    progress.note("warning: " + predict::describe_overlap(*deepest, plan.segments.size()));
  return overlaps;
}

/// What a face is meshed from.
struct FaceInputs {
  const ScannedHead& head;
  const geometry::TriangleMesh& skin_L;
  const plan::CutSegments& cut;
  const std::vector<plan::PlannedSegment>& planned;
  const predict::BoundaryLabelMap* painted;  ///< Boundary conditions, or null.
  const plan::Landmarks& landmarks;
  const predict::JawTeeth* teeth;  ///< Or null.
};

/// The lips of the plan's options and landmarks.
predict::TissueWithLips make_lips(mesh::VolumeMesh tissue, const predict::TissueDomain& domain,
                                  const FaceInputs& face, predict::Lips wanted,
                                  Progress& progress) {
  predict::FissureSearch search{std::nullopt, "boundary.lips is joined"};
  if (wanted == predict::Lips::kSeparate)
    search = predict::find_oral_fissure(face.head.labels, domain.soft_tissue_level,
                                        {.stomion_L = plan::find_landmark(face.landmarks, "Stm"),
                                         .right_L = plan::find_landmark(face.landmarks, "Ch-R"),
                                         .left_L = plan::find_landmark(face.landmarks, "Ch-L")},
                                        face.teeth);
  predict::TissueWithLips found =
      predict::separate_lips(std::move(tissue), domain, std::move(search));
  progress.note(predict::describe(found.lips));
  return found;
}

/// The mesh with regions, lips and boundary conditions.
struct Tissue {
  predict::TissueBoundary boundary;
  predict::LipSlit lips;
  mesh::VolumeMesh layered;  ///< Linear mesh with wedges, if the elements are quadratic.
};
Result<Tissue> make_tissue(const FaceInputs& face, const predict::TissueOptions& options,
                           const predict::BoundaryOptions& boundary, const StageCache& cache,
                           Progress& progress) {
  const ScannedHead& head = face.head;
  const image::CtVolume& ct = head.scan.ct;
  const geometry::TriangleMesh& remainder_L = face.cut.remainder_L;
  geometry::TriangleMesh segments_L;
  for (const geometry::TriangleMesh& segment_L : face.cut.segments_L)
    plan::append(segments_L, segment_L);
  const predict::TissueDomain domain = predict::make_tissue_domain(
      anatomy::soft_tissue_level(ct, head.labels, head.levels, progress), ct.grid, segments_L,
      options);
  const std::string key = tissue_key(head.ct_sha256, head.labels, head.levels, segments_L,
                                     remainder_L, options, boundary.contact_snap_mm);
  LEFORT_TRY(mesh::VolumeMesh tissue,
             find_tissue_mesh(domain, face.skin_L, segments_L, remainder_L, options,
                              boundary.contact_snap_mm, key, cache, progress));
  tissue = predict::assign_tissue_regions(std::move(tissue), options, head.labels, progress);
  progress.begin_stage("find boundaries");
  predict::TissueWithLips with_lips =
      make_lips(std::move(tissue), domain, face, boundary.lips, progress);
  mesh::VolumeMesh layered;
  if (options.element_order == 2) {
    if (options.skin) layered = with_lips.tissue;
    LEFORT_TRY(with_lips, predict::second_order_tissue(std::move(with_lips), domain, progress));
  }
  const std::vector<plan::ElevationZone> zones =
      plan::elevation_zones(face.cut, face.planned, boundary.elevation_margin_mm);
  return Tissue{
      predict::find_tissue_boundary(std::move(with_lips.tissue), domain, head.labels, face.skin_L,
                                    {.segments_L = face.cut.segments_L,
                                     .remainder_L = remainder_L,
                                     .elevation = zones,
                                     .teeth = face.teeth},
                                    boundary, face.painted),
      std::move(with_lips.lips), std::move(layered)};
}

/// The field of stationary bone, if tissue meets it.
Result<std::optional<predict::ContactBone>> find_stationary_bone(
    const predict::TissueBoundary& boundary, const geometry::TriangleMesh& remainder_L,
    const io::PlanFile& plan, const StageCache& cache, Progress& progress) {
  if (!boundary.tissue.face_sets.contains(predict::sets::kStationaryContact) &&
      !predict::slides_on_stationary_bone(boundary.interface))
    return std::nullopt;
  LEFORT_TRY(auto field, find_field("remainder", remainder_L, bone_field_options(plan, remainder_L),
                                    cache, progress));
  return predict::ContactBone{remainder_L, std::move(field)};
}

/// Releases tissue where bones overlap along the path, and reports it.
Result<void> release_overlapping_bone(predict::FaceModel& model, const io::PlanFile& plan,
                                      const predict::BoundaryOptions& boundary,
                                      Progress& progress) {
  if (boundary.interface != predict::TissueInterface::kClinical) return {};
  LEFORT_TRY(const Index released, predict::release_overlap(model, plan::paths_of(plan.segments),
                                                            plan.boundary.contact_snap_mm));
  if (released > 0)
    progress.note(fmt::format(
        "warning: bones overlap along the path: {} nodes of the tissue there are free, as "
        "if this bone had been removed",
        released));
  return {};
}

/// Reports the conditions of the boundary, paint without effect, and a scan that ends too close.
void note_boundary(const predict::TissueBoundary& boundary, const io::PlanFile& plan,
                   bool is_painted, Progress& progress) {
  progress.note(predict::describe_boundary(boundary.tissue, plan.boundary));
  if (is_painted && predict::all_painted_nodes(boundary.tissue).empty())
    progress.note(
        "warning: boundary.labels has no effect: no node of the tissue's boundary lies in a "
        "painted voxel");
  if (const auto mm = predict::distance_to_scan_boundary(boundary.tissue))
    progress.note(
        fmt::format("warning: the scan ends {:.1f} mm from a mobilized segment, within "
                    "the region of interest; the face is less certain there ({})",
                    *mm, name_of(plan.boundary.scan_boundary)));
}

/// The triangular boundary faces of a linear mesh with the corners of the given faces. Parts of a
/// quadrilateral, which a second-order mesh has, are left out.
std::vector<mesh::Face> linear_triangles(std::span<const mesh::Face> faces,
                                         const mesh::VolumeMesh& linear) {
  const auto corners_of = [](const mesh::Face& face) {
    std::array<std::int32_t, 3> corners{face.nodes[0], face.nodes[1], face.nodes[2]};
    std::sort(corners.begin(), corners.end());
    return corners;
  };
  std::set<std::array<std::int32_t, 3>> wanted;
  for (const mesh::Face& face : faces)
    if (mesh::corner_count(face.shape) == 3) wanted.insert(corners_of(face));
  std::vector<mesh::Face> triangles;
  for (const mesh::Face& face : mesh::boundary_faces(linear))
    if (face.shape == mesh::FaceShape::kTri3 && wanted.contains(corners_of(face)))
      triangles.push_back(face);
  return triangles;
}

/// \param tissue   with its sets.
/// \param layered  with the wedges of the skin.
/// \returns the thickness of the skin's layer, if the plan has a material for skin.
std::optional<mesh::LayerThickness> measure_skin_layer(const mesh::VolumeMesh& tissue,
                                                       const mesh::VolumeMesh& layered,
                                                       const predict::TissueOptions& options,
                                                       const mesh::MeshQuality& quality,
                                                       Progress& progress) {
  if (!options.skin) return std::nullopt;
  const mesh::LayerThickness layer = mesh::layer_thickness_statistics(
      layered, predict::regions::kSkin,
      linear_triangles(tissue.face_sets.at(predict::sets::kSkin), layered), options.skin->layers,
      options.skin->thickness_mm);
  progress.note(
      fmt::format("skin: {:.2f} mm thick on average, wedges under {:.1f} % of {:.0f} mm2; {} "
                  "elements, smallest scaled Jacobian {:.3f}",
                  layer.mean_mm, 100.0 * layer.covered_fraction, layer.area_mm2, quality.elements,
                  quality.min_scaled_jacobian));
  return layer;
}

Provenance provenance_of(const io::PlanFile& plan, const std::string& plan_sha256,
                         const ScannedHead& head) {
  return {.plan_sha256 = plan_sha256,
          .ct_sha256 = head.ct_sha256,
          .ct_kind = head.scan.source_kind,
          .labels_sha256 = io::Sha256().add(head.labels).hex(),
          .labels_source = plan.labels ? "file" : "segmented",
          .warnings = head.scan.warnings};
}

}  // namespace

Result<PreparedCase> prepare_case(io::PlanFile plan, const std::string& plan_sha256,
                                  const fs::path& ct_path, const StageCache& cache,
                                  Progress& progress) {
  LEFORT_TRY(ScannedHead head, scan_head(plan, ct_path, cache, progress));
  const image::Grid grid = head.scan.ct.grid;
  LEFORT_TRY_VOID(predict::check_muscle_labels(plan.tissue, head.labels));
  std::optional<predict::BoundaryLabelMap> painted;
  if (plan.boundary_labels) {
    LEFORT_TRY(painted, io::read_boundary_labels(*plan.boundary_labels, grid, progress));
  }
  LEFORT_TRY(std::optional<predict::JawTeeth> teeth, load_teeth(plan, head, progress));
  LEFORT_TRY(geometry::TriangleMesh skin_L,
             anatomy::extract_isosurface(
                 anatomy::skin_level(head.scan.ct, head.labels, head.levels), {}, progress));
  LEFORT_TRY(BonesAndFields bones, cut_bone(plan, head, cache, progress));
  LEFORT_TRY(std::vector<predict::BoneOverlapAtFraction> overlaps,
             find_overlaps(bones, plan, cache, progress));
  LEFORT_TRY(Tissue made,
             make_tissue({head, skin_L, bones.cut, plan.segments, painted ? &*painted : nullptr,
                          plan.landmarks, teeth ? &*teeth : nullptr},
                         plan.tissue, plan.boundary, cache, progress));
  predict::TissueBoundary& boundary = made.boundary;
  note_boundary(boundary, plan, painted.has_value(), progress);
  LEFORT_TRY(std::optional<predict::ContactBone> stationary_bone,
             find_stationary_bone(boundary, bones.cut.remainder_L, plan, cache, progress));
  mesh::VolumeMesh& tissue = boundary.tissue;
  mesh::MeshQuality quality = mesh::measure_quality(tissue);
  std::optional<mesh::LayerThickness> skin_layer = measure_skin_layer(
      tissue, made.layered.blocks.empty() ? tissue : made.layered, plan.tissue, quality, progress);
  predict::FaceModel model{.tissue = std::move(tissue),
                           .segments = std::move(bones.segments),
                           .stationary_bone = std::move(stationary_bone),
                           .interface = std::move(boundary.interface),
                           .lips = std::move(made.lips)};
  LEFORT_TRY_VOID(release_overlapping_bone(model, plan, plan.boundary, progress));
  LEFORT_TRY_VOID(find_obstacles(model, plan, plan.tissue, plan.boundary.interface,
                                 ObstacleMotion::kPlanned, cache, progress));
  Provenance provenance = provenance_of(plan, plan_sha256, head);
  return PreparedCase{std::move(plan),
                      std::move(provenance),
                      grid,
                      anatomy::tissue_volumes_ml(head.labels),
                      std::move(skin_L),
                      std::move(bones.cut),
                      std::move(model),
                      std::move(quality),
                      std::move(skin_layer),
                      std::move(overlaps),
                      std::move(head),
                      std::move(painted),
                      std::move(teeth)};
}

namespace {

/// \param obstacles  options of the mesh whose elements the obstacles resolve.
Result<predict::FaceModel> remodel(const PreparedCase& prepared,
                                   const predict::TissueOptions& tissue,
                                   const predict::TissueOptions& obstacles,
                                   const predict::BoundaryOptions& boundary, ObstacleMotion motion,
                                   const StageCache& cache, Progress& progress) {
  LEFORT_TRY(Tissue made,
             make_tissue({prepared.head, prepared.skin_L, prepared.cut, prepared.plan.segments,
                          prepared.painted ? &*prepared.painted : nullptr, prepared.plan.landmarks,
                          prepared.teeth ? &*prepared.teeth : nullptr},
                         tissue, boundary, cache, progress));
  predict::TissueBoundary& found = made.boundary;
  const geometry::TriangleMesh& remainder_L = prepared.cut.remainder_L;
  LEFORT_TRY(std::optional<predict::ContactBone> stationary_bone,
             find_stationary_bone(found, remainder_L, prepared.plan, cache, progress));
  predict::FaceModel model{.tissue = std::move(found.tissue),
                           .segments = prepared.model.segments,
                           .stationary_bone = std::move(stationary_bone),
                           .interface = std::move(found.interface),
                           .lips = std::move(made.lips)};
  if (motion == ObstacleMotion::kPlanned) {
    LEFORT_TRY_VOID(release_overlapping_bone(model, prepared.plan, boundary, progress));
  }
  LEFORT_TRY_VOID(
      find_obstacles(model, prepared.plan, obstacles, boundary.interface, motion, cache, progress));
  return model;
}

}  // namespace

Result<predict::FaceModel> remodel_face(const PreparedCase& prepared,
                                        const predict::TissueOptions& tissue,
                                        const predict::BoundaryOptions& boundary,
                                        const StageCache& cache, Progress& progress) {
  return remodel(prepared, tissue, tissue, boundary, ObstacleMotion::kPlanned, cache, progress);
}

Result<predict::FacePreview> preview_face(const PreparedCase& prepared,
                                          const geometry::TriangleMesh& skin_L,
                                          const StageCache& cache, Progress& progress) {
  const predict::PredictionOptions options{predict::preview_tissue(prepared.plan.tissue),
                                           prepared.plan.boundary, prepared.plan.contact,
                                           prepared.plan.solver};
  LEFORT_TRY(predict::FaceModel model,
             remodel(prepared, options.tissue, prepared.plan.tissue, options.boundary,
                     ObstacleMotion::kAny, cache, progress));
  return predict::FacePreview::create(std::move(model), prepared.segment_names(), skin_L, options,
                                      prepared.scan_grid.spacing_mm, progress);
}

}  // namespace lefort::pipeline
