/// \file
/// What contact does, as the bone sees it: brought from the tissue's nodes to the bone's surface.
#pragma once

#include <lefort/contact/contact_term.h>
#include <lefort/core/types.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/mesh/volume_mesh.h>

#include <span>
#include <vector>

namespace lefort::contact {

/// One value per vertex of a bone; 0 where nothing presses on it.
struct BoneContactFields {
  std::vector<double> pressure_mpa;
  std::vector<double> depth_mm;  ///< As NodalContact::depth_mm.
};

/// Each vertex takes what the nearest point of the tissue's faces has, linear between their nodes,
/// if that point is no further than `near_mm` and faces the bone (in a thin wall the nearest tissue
/// may be that on its other side).
///
/// \param bone_L    where it is now; \pre check_surface(bone_L).
/// \param x_L       current positions of all nodes of the tissue [mm].
/// \param faces     that may touch the bone.
/// \param at_nodes  ContactTerm::at_nodes() of these faces at x_L.
/// \param near_mm   how far apart bone and tissue in contact may be, >= 0.
/// \note Same bits for any number of threads.
[[nodiscard]] BoneContactFields project_contact_to_bone(const geometry::TriangleMesh& bone_L,
                                                        std::span<const Vec3> x_L,
                                                        std::span<const mesh::Face> faces,
                                                        std::span<const NodalContact> at_nodes,
                                                        double near_mm);

}  // namespace lefort::contact
