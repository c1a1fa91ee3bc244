#include <lefort/core/version.h>
#include <lefort/io/sha256.h>
#include <lefort/pipeline/cache/stage_keys.h>
#include <lefort/predict/mesh_tissue.h>

namespace lefort::pipeline {
namespace {

// Raise with every change of a stage's code that may change its result.
constexpr double kLabelsRevision = 7;
constexpr double kFieldRevision = 6;
constexpr double kTissueRevision = 7;
constexpr double kSkinRevision = 2;

}  // namespace

// Structured bindings name every member: a new member fails to compile until it is in the key.

std::string labels_key(const std::string& ct_sha256, const anatomy::SegmentationOptions& options) {
  const auto& [bone_hu, skin_hu, min_bone_ml, nostril_radius_mm, ostium_radius_mm, min_air_ml,
               max_memory_gib] = options;
  static_cast<void>(max_memory_gib);  // Does not change the result.
  return io::Sha256()
      .add(kVersion)
      .add(kLabelsRevision)
      .add(ct_sha256)
      .add(bone_hu)
      .add(skin_hu)
      .add(min_bone_ml)
      .add(nostril_radius_mm)
      .add(ostium_radius_mm)
      .add(min_air_ml)
      .hex();
}

std::string field_key(const geometry::TriangleMesh& segment_B,
                      const field::DistanceFieldOptions& options) {
  const auto& [method, resolution, band_mm, tolerance_mm, relative_tolerance, margin_mm, side_mm,
               smooth] = options;
  return io::Sha256()
      .add(kVersion)
      .add(kFieldRevision)
      .add(segment_B)
      .add(double(method))
      .add(resolution)
      .add(band_mm)
      .add(tolerance_mm)
      .add(relative_tolerance)
      .add(margin_mm)
      .add(side_mm)
      .add(double(smooth))
      .hex();
}

std::string tissue_key(const std::string& ct_sha256, const anatomy::LabelMap& labels,
                       const anatomy::LevelOptions& levels, const geometry::TriangleMesh& segment_L,
                       const geometry::TriangleMesh& remainder_L,
                       const predict::TissueOptions& options, double contact_snap_mm) {
  const auto& [bone_hu, skin_hu, bone_smoothing_mm, skin_smoothing_mm, thinnest_tissue_mm,
               nostril_depth_mm] = levels;
  // The material does not change the mesh.
  const auto& [young_mpa, poisson, element_size_mm, far_element_size_mm, element_order, margin_mm,
               skin, mucosa, muscle, face] = options;
  static_cast<void>(element_order);  // The linear mesh is kept.
  static_cast<void>(mucosa);         // Assigned after meshing.
  static_cast<void>(muscle);         // As mucosa.
  io::Sha256 hash;
  hash.add(kVersion)
      .add(kTissueRevision)
      .add(ct_sha256)
      .add(labels)
      .add(bone_hu)
      .add(skin_hu)
      .add(bone_smoothing_mm)
      .add(skin_smoothing_mm)
      .add(thinnest_tissue_mm)
      .add(nostril_depth_mm)
      .add(segment_L)
      .add(element_size_mm)
      .add(far_element_size_mm)
      .add(margin_mm)
      .add(predict::kSurfaceDistanceFraction);
  if (face) {
    const auto& [face_size_mm, points_L] = *face;
    hash.add(std::string_view("face")).add(face_size_mm).add(double(points_L.size()));
    for (const Vec3& p_L : points_L) hash.add(p_L);
  }
  if (skin) {
    const auto& [thickness_mm, layers, skin_young_mpa, skin_poisson] = *skin;
    hash.add(kSkinRevision).add(remainder_L).add(contact_snap_mm).add(thickness_mm).add(layers);
  }
  return hash.hex();
}

}  // namespace lefort::pipeline
