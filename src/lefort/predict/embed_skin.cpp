#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/geometry/bvh.h>
#include <lefort/mesh/boundary_faces.h>
#include <lefort/predict/embed_skin.h>
#include <lefort/predict/mesh_tissue.h>
#include <lefort/predict/separate_lips.h>

#include <algorithm>
#include <set>
#include <span>
#include <utility>
#include <vector>

namespace lefort::predict {
namespace {

/// 1 up to `near`, 0 beyond `far`, smooth between (cubic Hermite step).
double fade(double distance, double near, double far) {
  const double t = std::clamp((far - distance) / (far - near), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

/// Barycentric coordinates of `p` in the plane of a triangle; `p` lies on it.
Vec3 barycentric(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = (b - a).cross(c - a);
  const double squared = normal.squaredNorm();
  if (!(squared > 0.0)) return Vec3::Constant(1.0 / 3.0);
  const double beta = (p - a).cross(c - a).dot(normal) / squared;
  const double gamma = (b - a).cross(p - a).dot(normal) / squared;
  return {1.0 - beta - gamma, beta, gamma};
}

/// Boundary faces that the skin can lie on: where the lips touch each other there is none.
std::vector<mesh::Face> faces_but_lips(const mesh::VolumeMesh& tissue) {
  std::vector<mesh::Face> faces = mesh::boundary_faces(tissue);
  std::set<std::vector<std::int32_t>> lips;
  const auto key = [](const mesh::Face& face) {
    const auto nodes = mesh::nodes_of(face);
    std::vector<std::int32_t> sorted(nodes.begin(), nodes.end());
    std::sort(sorted.begin(), sorted.end());
    return sorted;
  };
  for (const char* name : {sets::kUpperLip, sets::kLowerLip})
    if (const auto set = tissue.face_sets.find(name); set != tissue.face_sets.end())
      for (const mesh::Face& face : set->second) lips.insert(key(face));
  if (!lips.empty())
    std::erase_if(faces, [&](const mesh::Face& face) { return lips.contains(key(face)); });
  return faces;
}

/// For each of triangles_of() some faces, its face.
std::vector<std::size_t> faces_of_triangles(const std::vector<mesh::Face>& faces) {
  std::vector<std::size_t> face_of;
  for (std::size_t f = 0; f < faces.size(); ++f)
    face_of.insert(face_of.end(), mesh::triangles_of(std::span(&faces[f], 1)).size(), f);
  return face_of;
}

/// Shape functions of a tri6 at a point of one of its four triangles.
///
/// \param weights  barycentric coordinates in the triangle, sum 1.
/// \param part     factor of the result.
SkinEmbedding::EmbeddedVertex in_quadratic(const mesh::Face& face, const mesh::Face3& triangle,
                                           const Vec3& weights, double part) {
  Vec3 L = Vec3::Zero();  // Barycentric coordinates in the face.
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t n = 0; n < 6; ++n) {
      if (face.nodes[n] != triangle[k]) continue;
      if (n < 3) L[Index(n)] += weights[Index(k)];
      if (n < 3) continue;
      L[Index(n) - 3] += 0.5 * weights[Index(k)];
      L[(Index(n) - 2) % 3] += 0.5 * weights[Index(k)];
    }
  SkinEmbedding::EmbeddedVertex vertex{.face = {face.nodes[0], face.nodes[1], face.nodes[2]},
                                       .middle = {face.nodes[3], face.nodes[4], face.nodes[5]}};
  for (Index i = 0; i < 3; ++i) {
    vertex.weights[i] = part * L[i] * (2.0 * L[i] - 1.0);
    vertex.middle_weights[i] = part * 4.0 * L[i] * L[(i + 1) % 3];
  }
  return vertex;
}

}  // namespace

double embedding_distance_mm(const TissueOptions& options, const Vec3& spacing_mm) {
  return 2.0 * (kSurfaceDistanceFraction * options.element_size_mm +
                kScanBoundaryInset_voxels * spacing_mm.maxCoeff());
}

SkinEmbedding embed_skin(const geometry::TriangleMesh& skin_L, const mesh::VolumeMesh& tissue,
                         double near_mm) {
  LEFORT_CHECK(near_mm > 0.0);
  const double far_mm = 4.0 * near_mm;
  const std::vector<mesh::Face> faces = faces_but_lips(tissue);
  const std::vector<mesh::Face3> triangles = mesh::triangles_of(faces);
  const std::vector<std::size_t> face_of = faces_of_triangles(faces);
  const geometry::Bvh boundary({tissue.nodes_L, triangles});

  SkinEmbedding embedding;
  embedding.embedded_vertices.resize(skin_L.vertices.size());
  parallel_for(skin_L.vertex_count(), [&](Index v) {
    const auto nearest = boundary.closest_point(skin_L.vertices[std::size_t(v)], far_mm);
    if (!nearest) return;
    const mesh::Face3& triangle = triangles[std::size_t(nearest->triangle)];
    const auto node = [&](int corner) -> const Vec3& {
      return tissue.nodes_L[std::size_t(triangle[std::size_t(corner)])];
    };
    const double part = fade(nearest->distance_mm, near_mm, far_mm);
    const Vec3 weights = barycentric(nearest->point, node(0), node(1), node(2));
    const mesh::Face& face = faces[face_of[std::size_t(nearest->triangle)]];
    embedding.embedded_vertices[std::size_t(v)] =
        face.shape == mesh::FaceShape::kTri6
            ? in_quadratic(face, triangle, weights, part)
            : SkinEmbedding::EmbeddedVertex{.face = triangle, .weights = part * weights};
  });
  return embedding;
}

std::vector<Vec3> skin_displacement(const SkinEmbedding& embedding,
                                    std::span<const Vec3> tissue_displacement_mm) {
  std::vector<Vec3> displacement_mm(embedding.embedded_vertices.size(), Vec3::Zero());
  parallel_for(Index(displacement_mm.size()), [&](Index v) {
    const SkinEmbedding::EmbeddedVertex& embedded = embedding.embedded_vertices[std::size_t(v)];
    for (int corner = 0; corner < 3; ++corner)
      displacement_mm[std::size_t(v)] +=
          embedded.weights[corner] *
          tissue_displacement_mm[std::size_t(embedded.face[std::size_t(corner)])];
    if (embedded.middle_weights.isZero(0.0)) return;
    for (int edge = 0; edge < 3; ++edge)
      displacement_mm[std::size_t(v)] +=
          embedded.middle_weights[edge] *
          tissue_displacement_mm[std::size_t(embedded.middle[std::size_t(edge)])];
  });
  return displacement_mm;
}

geometry::TriangleMesh displaced(geometry::TriangleMesh surface,
                                 std::span<const Vec3> displacement_mm) {
  LEFORT_CHECK(surface.vertices.size() == displacement_mm.size());
  for (std::size_t v = 0; v < displacement_mm.size(); ++v)
    surface.vertices[v] += displacement_mm[v];
  return surface;
}

}  // namespace lefort::predict
