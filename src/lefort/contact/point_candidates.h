/// \file
/// Points of bones that may lie behind a node patch, noted at one state. States close to the noted
/// one then need no search.
///
/// The distance between a point of a bone and a face changes by at most the motion m of the nodes
/// of the face relative to the bone (|grad d| <= 1; \cite macklin2020). With the distance d of the
/// point to the faces of a patch, and the distance f to all faces if it lies in front of them, both
/// at the noted state, the point
///
///   - is not closer to the patch than d - m now,
///   - is still in front of the faces if f > m.
#pragma once

#include <lefort/contact/bone_points.h>
#include <lefort/contact/node_patches.h>
#include <lefort/contact/rigid_obstacle.h>
#include <lefort/core/types.h>
#include <lefort/mesh/volume_mesh.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lefort::contact {

/// A point near a patch.
struct PointCandidate {
  std::uint32_t bone = 0;
  std::uint32_t point = 0;   ///< Its number among the points of the bone.
  double distance_mm = 0.0;  ///< d, to the closest face of the patch.
  double in_front_mm = 0.0;  ///< f, to the closest of all faces; 0 if it may lie behind them.
};

/// Candidates of all patches at one state. Immutable.
class PointCandidates {
 public:
  /// No state has been noted.
  PointCandidates() = default;

  /// \param patches   around the nodes of `faces`.
  /// \param faces     contact faces.
  /// \param points    of each bone; may be empty.
  /// \param bones     at their poses.
  /// \param x_L       positions of all nodes [mm].
  /// \param range_mm  points within this distance of a patch are candidates.
  PointCandidates(const NodePatches& patches, std::span<const mesh::Face> faces,
                  std::span<const BonePoints* const> points, std::span<const RigidObstacle> bones,
                  std::span<const Vec3> x_L, double range_mm);

  [[nodiscard]] double range_mm() const { return range_mm_; }

  /// \returns the candidates, ascending by bone and point; nothing if no state has been noted.
  [[nodiscard]] std::span<const PointCandidate> of(std::size_t patch) const {
    return patches_.empty() ? std::span<const PointCandidate>() : patches_[patch];
  }

 private:
  double range_mm_ = 0.0;
  std::vector<std::vector<PointCandidate>> patches_;
};

}  // namespace lefort::contact
