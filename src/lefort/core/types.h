/// \file
/// Types of all layers: vectors, indices and rigid transforms.
///
/// Frames are letters at the end of a name (docs/conventions.md):
///   L  the patient: LPS, x to the patient's left, y to posterior, z to superior, mm
///   B  a bone as scanned, before the plan moves it; same axes as L
///   V  voxel indices (column i, row j, slice k) of a volume
/// X_LB maps a point from B to L: p_L = X_LB * p_B.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace lefort {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using VectorX = Eigen::VectorXd;

/// Sizes of lists and positions in them.
using Index = Eigen::Index;

/// Rotation, then translation; no scale.
using RigidTransform = Eigen::Isometry3d;

/// Axis-aligned box; empty until extended.
using Box3 = Eigen::AlignedBox3d;

}  // namespace lefort
