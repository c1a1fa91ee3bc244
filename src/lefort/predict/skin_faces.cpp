#include <lefort/core/parallel.h>
#include <lefort/geometry/bvh.h>
#include <lefort/mesh/boundary_faces.h>
#include <lefort/mesh/boundary_layer.h>
#include <lefort/predict/skin_faces.h>

#include <algorithm>
#include <cstdint>

namespace lefort::predict {

std::vector<mesh::Face> skin_faces(const mesh::VolumeMesh& tissue, const TissueDomain& domain,
                                   const geometry::TriangleMesh& skin_L,
                                   const geometry::TriangleMesh& segment_L,
                                   const geometry::TriangleMesh& remainder_L,
                                   double contact_snap_mm) {
  enum class Location : std::uint8_t { kElsewhere, kCutPlane, kSkin };
  const geometry::Bvh skin(skin_L), segment(segment_L), remainder(remainder_L);
  const auto is_closer_to_skin = [&](const Vec3& p_L) {
    const auto nearest = skin.closest_point(p_L, contact_snap_mm);
    return nearest && !segment.closest_point(p_L, nearest->distance_mm) &&
           !remainder.closest_point(p_L, nearest->distance_mm);
  };
  const std::vector<mesh::Face> boundary = mesh::boundary_faces(tissue);
  const std::vector<std::int32_t> nodes = mesh::nodes_of_faces(boundary);
  std::vector<Location> location(tissue.nodes_L.size(), Location::kElsewhere);
  parallel_for(Index(nodes.size()), [&](Index n) {
    const auto node = std::size_t(nodes[std::size_t(n)]);
    const Vec3& p_L = tissue.nodes_L[node];
    if (std::min(domain.distance_to_cut(p_L), domain.distance_to_scan_boundary(p_L)) <=
        kPlaneTolerance_mm)
      location[node] = Location::kCutPlane;
    else if (is_closer_to_skin(p_L))
      location[node] = Location::kSkin;
  });
  const auto is_cut_off = [&](const mesh::Face3& face,
                              const std::vector<mesh::HalfSpace>& cut_planes) {
    return std::any_of(cut_planes.begin(), cut_planes.end(), [&](const mesh::HalfSpace& plane) {
      return mesh::is_cut_face(tissue.nodes_L, face, plane);
    });
  };
  std::vector<mesh::Face> faces;
  for (const mesh::Face& face : boundary) {
    const mesh::Face3 corners{face.nodes[0], face.nodes[1], face.nodes[2]};
    const auto count = [&](Location wanted) {
      return std::count_if(corners.begin(), corners.end(), [&](std::int32_t node) {
        return location[std::size_t(node)] == wanted;
      });
    };
    if (count(Location::kElsewhere) == 0 && count(Location::kSkin) > 0 &&
        !is_cut_off(corners, domain.cuts_L) && !is_cut_off(corners, domain.scan_boundaries_L))
      faces.push_back(face);
  }
  return faces;
}

}  // namespace lefort::predict
