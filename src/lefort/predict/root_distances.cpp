#include <lefort/geometry/bvh.h>
#include <lefort/plan/elevation_zone.h>
#include <lefort/predict/root_distances.h>

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace lefort::predict {
namespace {

/// The tooth voxels of one jaw.
std::vector<Vec3> centers_of(const anatomy::ToothMap& teeth, anatomy::Tooth jaw) {
  std::vector<Vec3> centers_L;
  const auto& size = teeth.grid.size;
  for (Index k = 0; k < size[2]; ++k)
    for (Index j = 0; j < size[1]; ++j)
      for (Index i = 0; i < size[0]; ++i)
        if (teeth.at(i, j, k) == jaw)
          centers_L.push_back(teeth.grid.point_L({double(i), double(j), double(k)}));
  return centers_L;
}

/// The faces in bone of one label.
geometry::TriangleMesh faces_in(const geometry::TriangleMesh& faces_L,
                                const anatomy::LabelMap& labels, anatomy::Tissue bone) {
  geometry::TriangleMesh part;
  part.vertices = faces_L.vertices;
  for (Index t = 0; t < faces_L.triangle_count(); ++t) {
    const Vec3 center_L =
        (faces_L.corner(t, 0) + faces_L.corner(t, 1) + faces_L.corner(t, 2)) / 3.0;
    const Vec3 at = labels.grid.index_V(center_L);
    const auto i = Index(std::lround(at.x())), j = Index(std::lround(at.y())),
               k = Index(std::lround(at.z()));
    if (labels.grid.contains(i, j, k) && labels.at(i, j, k) == bone)
      part.triangles.push_back(faces_L.triangles[std::size_t(t)]);
  }
  return part;
}

/// Whether a procedure cuts that jaw. The planes of a Le Fort osteotomy reach into the mandible,
/// whose bone is not cut (perform_osteotomy.h); any other cut may be in both.
bool cuts_jaw(const plan::Osteotomy& osteotomy, anatomy::Tooth jaw) {
  if (!osteotomy.procedure) return true;
  const bool is_of_mandible = *osteotomy.procedure == plan::OsteotomyTemplate::kGenioplasty ||
                              *osteotomy.procedure == plan::OsteotomyTemplate::kSagittalSplit;
  return is_of_mandible == (jaw == anatomy::Tooth::kLower);
}

/// The number at the center of a voxel.
int number_at(const image::Volume<std::uint8_t>* numbers, const Vec3& p_L) {
  if (numbers == nullptr) return 0;
  const Vec3 at = numbers->grid.index_V(p_L);
  return numbers->at(Index(std::lround(at.x())), Index(std::lround(at.y())),
                     Index(std::lround(at.z())));
}

}  // namespace

std::vector<RootDistance> root_distances(const plan::CutSegments& cut,
                                         std::span<const plan::PlannedSegment> planned,
                                         const anatomy::LabelMap& labels,
                                         const anatomy::ToothMap& teeth,
                                         const image::Volume<std::uint8_t>* numbers,
                                         double within_mm) {
  constexpr std::array kJaws{anatomy::Tooth::kUpper, anatomy::Tooth::kLower};
  constexpr std::array kBones{anatomy::Tissue::kBone, anatomy::Tissue::kMandible};
  const std::array centers_L{centers_of(teeth, kJaws[0]), centers_of(teeth, kJaws[1])};
  // With the faces of segments that were later cut from the segment.
  const auto zones = plan::elevation_zones(cut, planned, std::nullopt);
  std::vector<RootDistance> found;
  for (std::size_t k = 0; k < planned.size(); ++k) {
    const geometry::TriangleMesh& cut_L = zones[k].cut_faces_L;
    for (std::size_t jaw = 0; jaw < kJaws.size(); ++jaw) {
      if (!cuts_jaw(planned[k].osteotomy, kJaws[jaw])) continue;
      geometry::TriangleMesh faces_L = faces_in(cut_L, labels, kBones[jaw]);
      if (faces_L.triangles.empty()) continue;
      const geometry::Bvh faces(std::move(faces_L));
      std::optional<RootDistance> closest;
      for (const Vec3& p_L : centers_L[jaw]) {
        const auto face = faces.closest_point(p_L, closest ? closest->distance_mm : within_mm);
        if (face && (!closest || face->distance_mm < closest->distance_mm))
          closest = {planned[k].osteotomy.segment, kJaws[jaw], face->distance_mm, p_L,
                     number_at(numbers, p_L)};
      }
      if (closest) found.push_back(*closest);
    }
  }
  return found;
}

std::string describe(const RootDistance& found, double limit_mm) {
  const auto name_of_tooth = [](const RootDistance& one) {
    if (one.fdi > 0) return fmt::format("tooth {}", one.fdi);
    return std::string(one.jaw == anatomy::Tooth::kUpper ? "an upper tooth" : "a lower tooth");
  };
  return fmt::format(
      "the cut of '{}' passes {:.1f} mm from {}, at ({:.0f}, {:.0f}, {:.0f}); the limit is "
      "{:g} mm",
      found.segment, found.distance_mm, name_of_tooth(found), found.tooth_L.x(), found.tooth_L.y(),
      found.tooth_L.z(), limit_mm);
}

}  // namespace lefort::predict
