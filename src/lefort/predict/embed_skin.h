/// \file
/// Carries the tissue's displacement to the skin surface people look at.
#pragma once

#include <lefort/core/types.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/mesh/volume_mesh.h>
#include <lefort/predict/prediction_options.h>

#include <span>
#include <vector>

namespace lefort::predict {

/// How much of which nodes' displacement each skin vertex follows; made once, used for every step.
struct SkinEmbedding {
  struct EmbeddedVertex {
    mesh::Face3 face{0, 0, 0};
    Vec3 weights = Vec3::Zero();  ///< Sum 1 near the tissue mesh, 0 beyond the region.
  };
  std::vector<EmbeddedVertex> embedded_vertices;  ///< One per skin vertex.
};

/// Binds each vertex of the whole skin to the nearest boundary face of the tissue mesh.
///
/// The finer skin and the mesh's boundary lie within a chord's height of each other; where the
/// region ends the weights fade to zero within a few times that, so that the skin stays smooth.
///
/// \param near_mm  vertices up to this far from the mesh follow it wholly, > 0:
///   embedding_distance_mm().
[[nodiscard]] SkinEmbedding embed_skin(const geometry::TriangleMesh& skin_L,
                                       const mesh::VolumeMesh& tissue, double near_mm);

/// How far skin may be from the tissue mesh that belongs to it: the mesh's distance from its
/// surface and the inset at the scan's edge (tissue_domain.h), with as much again to spare.
[[nodiscard]] double embedding_distance_mm(const TissueOptions& options, const Vec3& spacing_mm);

/// Displacement of every skin vertex [mm].
[[nodiscard]] std::vector<Vec3> skin_displacement(const SkinEmbedding& binding,
                                                  std::span<const Vec3> tissue_displacement_mm);

/// A surface with its vertices moved. \pre one displacement per vertex.
[[nodiscard]] geometry::TriangleMesh displaced(geometry::TriangleMesh surface,
                                               std::span<const Vec3> displacement_mm);

}  // namespace lefort::predict
