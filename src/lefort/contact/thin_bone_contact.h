/// \file
/// On which side of thin bone a point of the tissue is.
///
/// The nearest surface tells no way out of thin bone: past the middle of a plate it is the far one,
/// and in a ridge one flank or the other, where the tip is what tissue must get off. So a point
/// remembers what it saw of the bone while it was on its own side. Where bone that it lies in
/// looks otherwise, the plane that touched the bone there holds it off: a wall without an edge to
/// creep over, whose potential is convex.
///
///            wall - - - - ___ - - - - -     sight: foot and normal on the tip
///                        / o \              o: nearest are the flanks, which push to and fro
#pragma once

#include <lefort/contact/measure_gap.h>
#include <lefort/core/types.h>

namespace lefort::contact {

/// What a point saw of the bone, in the bone's frame.
struct ContactReference {
  Vec3 foot_B = Vec3::Zero();    ///< The nearest point of its surface [mm].
  Vec3 normal_B = Vec3::Zero();  ///< There, out of the bone, of length one; zero beyond the band.
  bool is_side_known = false;    ///< The detector said where the point was.

  [[nodiscard]] bool has_tangent_plane() const { return normal_B.squaredNorm() > 0.0; }
};

/// \param gap  of p_L, as measure_gap() says.
[[nodiscard]] ContactReference contact_reference(const RigidObstacle& obstacle, const Vec3& p_L,
                                                 const Gap& gap);

/// From the plane that touches the bone at a sight's foot. \pre last.has_tangent_plane().
[[nodiscard]] Gap gap_to_tangent_plane(const RigidObstacle& obstacle, const Vec3& p_L,
                                       const ContactReference& last);

/// Whether a point lies in bone whose nearest surface is not the one it saw last, and would have to
/// go further to get off that one: then it has come past the middle. In a corner of the bone, where
/// one wall takes over from another, the nearest surface is right.
[[nodiscard]] bool has_crossed_medial_surface(const RigidObstacle& obstacle, const Vec3& p_L,
                                              const Gap& gap, const ContactReference& last);

/// Whether a point that was past the middle sees its side again: it is off the bone, or the nearest
/// surface looks as it did. Later than has_crossed_medial_surface() says no, so that it does not go
/// to and fro.
[[nodiscard]] bool has_returned(const RigidObstacle& obstacle, const Vec3& p_L, const Gap& gap,
                                const ContactReference& last);

}  // namespace lefort::contact
