/// \file
/// Fragments of an osteotomy: which part of the bone each loose piece belongs to.
#pragma once

#include <lefort/geometry/triangle_mesh.h>
#include <lefort/plan/bone_bodies.h>

#include <vector>

namespace lefort::plan {

/// The part of the bone to which a fragment belongs.
enum class FragmentOwner {
  kRemainder,  ///< The bone from which the segment is cut: the fragment does not move with it.
  kSegment,    ///< The fragment moves with the segment.
  kNone        ///< Left out: in no part.
};

/// \returns "remainder", "segment" or "none".
[[nodiscard]] const char* name_of(FragmentOwner owner);

/// A piece of bone that an osteotomy makes beside the segment and the rest of the bone.
struct Fragment {
  double volume_mm3 = 0.0;
  Vec3 center_L = Vec3::Zero();  ///< Mean of the vertices [mm].
  FragmentOwner owner = FragmentOwner::kRemainder;
  bool is_within_cut = true;  ///< False: on the side of the remainder.
  geometry::TriangleMesh surface_L;
};

/// Smaller pieces that touch no other bone are left out: a voxel of a clinical scan has 0.2 to 1.
inline constexpr double kMinFragment_mm3 = 1.0;

/// The two sides of a cut.
struct CutSides {
  geometry::TriangleMesh segment_L;
  std::vector<BoneBody> within;  ///< Other pieces on the side of the segment.
  geometry::TriangleMesh outside_L;
};

/// Segment and remainder, both closed, with the fragments they own.
struct OwnedBone {
  geometry::TriangleMesh segment_L;
  geometry::TriangleMesh remainder_L;
  std::vector<Fragment> fragments;
  double left_out_mm3 = 0.0;  ///< Volume of fragments without an owner.
};

/// Gives each fragment to a part of the bone, in this order:
///   1. A piece within the cut that shares a cut face with the bone outside it belongs to the
///      remainder. A piece outside the cut that is smaller than `min_piece_mm3`, and whose cut
///      faces touch the segment more than other pieces, belongs to the segment.
///   2. A piece within the cut that touches nothing is a bone of its own if it has `min_piece_mm3`
///      or more, and belongs to the remainder.
///   3. Smaller ones belong to the nearer of segment and remainder, or are left out below
///      kMinFragment_mm3.
/// A fragment is stitched to its owner along the cut face they share. If the result would not be
/// closed, it stays a piece of its own that touches the owner.
///
/// \param sides          of one cut, whose caps have equal triangles of opposite orientation.
/// \param min_piece_mm3  bound of volume, >= 0.
/// \returns both parts. Their volumes and the volume left out add up to those of `sides`.
[[nodiscard]] OwnedBone assign_fragments(CutSides sides, double min_piece_mm3);

/// Stitches surfaces that were cut from each other (mesh/stitch_surfaces.h).
///
/// \returns a closed surface: two that touch along the cut if the stitched one is not closed.
[[nodiscard]] geometry::TriangleMesh joined(const geometry::TriangleMesh& a,
                                            const geometry::TriangleMesh& b);

}  // namespace lefort::plan
