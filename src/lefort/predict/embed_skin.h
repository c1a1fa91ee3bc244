/// \file
/// Interpolates the displacement of the tissue mesh at the vertices of the skin surface.
#pragma once

#include <lefort/core/types.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/mesh/volume_mesh.h>
#include <lefort/predict/prediction_options.h>

#include <span>
#include <vector>

namespace lefort::predict {

/// Weights of nodal displacements for each skin vertex; computed once, used for every step.
struct SkinEmbedding {
  struct EmbeddedVertex {
    mesh::Face3 face{0, 0, 0};
    Vec3 weights = Vec3::Zero();  ///< Of its corners.
    /// Mid-edge nodes of a quadratic face and their weights; zero for a linear one. All weights
    /// together: sum 1 near the tissue mesh, 0 beyond the region.
    mesh::Face3 middle{0, 0, 0};
    Vec3 middle_weights = Vec3::Zero();
  };
  std::vector<EmbeddedVertex> embedded_vertices;  ///< One per skin vertex.
};

/// Embeds each vertex of the skin in the closest boundary face of the tissue mesh. Faces at which
/// the lips touch each other are left out.
///
/// Within `near_mm` of the mesh the weights are the shape functions of the face; they decrease
/// smoothly to zero at four times that distance, so that the skin stays smooth where the region
/// ends.
///
/// \param skin_L   the whole skin surface.
/// \param tissue   mesh of the region.
/// \param near_mm  embedding_distance_mm(), > 0.
[[nodiscard]] SkinEmbedding embed_skin(const geometry::TriangleMesh& skin_L,
                                       const mesh::VolumeMesh& tissue, double near_mm);

/// Distance from the tissue mesh within which a skin vertex belongs to it: twice the sum of the
/// tolerance of the mesh (mesh_tissue.h) and the inset at the scan boundary (tissue_domain.h).
///
/// \param options     its element size is used.
/// \param spacing_mm  of the scan.
[[nodiscard]] double embedding_distance_mm(const TissueOptions& options, const Vec3& spacing_mm);

/// \param embedding               of the skin.
/// \param tissue_displacement_mm  one per node of the tissue mesh.
/// \returns the displacement of every skin vertex [mm].
[[nodiscard]] std::vector<Vec3> skin_displacement(const SkinEmbedding& embedding,
                                                  std::span<const Vec3> tissue_displacement_mm);

/// The surface with displaced vertices. \pre one displacement per vertex.
[[nodiscard]] geometry::TriangleMesh displaced(geometry::TriangleMesh surface,
                                               std::span<const Vec3> displacement_mm);

}  // namespace lefort::predict
