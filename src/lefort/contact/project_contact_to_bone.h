/// \file
/// Projection of contact results from the nodes of the tissue to the vertices of the bone.
#pragma once

#include <lefort/contact/contact_term.h>
#include <lefort/core/types.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/mesh/volume_mesh.h>

#include <span>
#include <vector>

namespace lefort::contact {

/// One value per vertex of a bone; 0 without contact.
struct BoneContactFields {
  std::vector<double> pressure_mpa;
  std::vector<double> depth_mm;  ///< NodalContact::depth_mm.
};

/// Each vertex takes the value at the closest point of the tissue faces, interpolated between their
/// nodes, if that point is at most `near_mm` away and its face faces the bone. (At a thin wall the
/// closest tissue may be that on the other side.)
///
/// \param bone_L    the bone at its present pose; \pre check_surface(bone_L).
/// \param x_L       current positions of all nodes of the tissue [mm].
/// \param faces     that may touch the bone.
/// \param at_nodes  ContactTerm::at_nodes() of these faces at x_L.
/// \param near_mm   max distance between bone and tissue in contact, >= 0.
/// \returns pressure and depth of each vertex.
/// \note The result is bitwise identical for any number of threads.
[[nodiscard]] BoneContactFields project_contact_to_bone(const geometry::TriangleMesh& bone_L,
                                                        std::span<const Vec3> x_L,
                                                        std::span<const mesh::Face> faces,
                                                        std::span<const NodalContact> at_nodes,
                                                        double near_mm);

}  // namespace lefort::contact
