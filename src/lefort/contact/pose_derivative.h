/// \file
/// Derivative of the forces of a bone by its pose.
///
/// The force of a rigid bone depends only on where the tissue is relative to the bone. If the bone
/// moves by the rigid motion Q, tissue at x has the force that tissue at Q^-1 x had, rotated:
///
///   r(x; Q X) = Q_R r(Q^-1 x; X)
///
/// Let q be a number of the motion, v(p) the velocity of the points of the bone by q, and w its
/// rotation (geometry::MotionRate). With dQ^-1 x / dq = -v(x), the derivative at Q = I is
///
///   dr_a/dq = w x r_a - sum_b K_ab v(x_b)
///
/// It needs the force and the exact tangent of the item only, and holds for every item whose state
/// (rest gaps) is stored in the frame of the bone.
#pragma once

#include <lefort/core/types.h>
#include <lefort/fem/assembly/force_term.h>
#include <lefort/geometry/motion_rates.h>

#include <span>

namespace lefort::contact {

/// \param term  its item depends on the pose of one bone, as above.
/// \param item  0 to term.item_count() - 1.
/// \param x_L   current positions of the nodes of the item [mm].
/// \param rates motions of the bone by several numbers.
/// \returns the derivatives of the forces on the nodes [N per unit of the number]: 3 rows per node,
///   one column per number; zero if the item is inadmissible.
[[nodiscard]] Eigen::MatrixXd pose_derivatives_n(const fem::ForceTerm& term, Index item,
                                                 std::span<const Vec3> x_L,
                                                 std::span<const geometry::MotionRate> rates);

/// The same for an item whose force depends on its distance from a point that follows a fraction of
/// the motion of the bone without rotating (NodalSupport::motion_fraction < 1): if the point moves
/// by w v(X), the force changes as if the tissue moved by -w v(X): dr/dq = -K w v(X).
///
/// \param fraction  w, 0 to 1.
/// \param point_L   X, the point of the bone that is followed [mm].
[[nodiscard]] Eigen::MatrixXd following_derivatives_n(const fem::ForceTerm& term, Index item,
                                                      std::span<const Vec3> x_L,
                                                      std::span<const geometry::MotionRate> rates,
                                                      double fraction, const Vec3& point_L);

}  // namespace lefort::contact
