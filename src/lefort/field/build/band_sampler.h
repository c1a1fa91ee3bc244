/// \file
/// Exact signed distances at the lattice points near a surface, brick by brick: the paper's steps 1
/// to 3.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/field/build/nearest_in_brick.h>
#include <lefort/field/build/prepare_surface.h>
#include <lefort/field/build/triangle_tree.h>
#include <lefort/field/field_frame.h>
#include <lefort/field/sign/brick_signs.h>
#include <lefort/field/sign/winding_scanlines.h>
#include <lefort/field/storage/sparse_lattice.h>

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace lefort::field {

/// Distance of a lattice point beyond the reach, before its side is known.
inline constexpr float kUnsampled = std::numeric_limits<float>::quiet_NaN();

/// Knows which triangles matter to which brick, and samples bricks one at a time, in any order and
/// from any thread.
///
/// The paper extrudes each triangle to a prism of +-band and visits the lattice points in the
/// prism's box. Prisms leave wedges at convex edges and cones at convex corners that belong to no
/// triangle, and boxes cover them by luck; here a triangle's share is its own box and plane, both
/// widened by the reach, which leaves no gap. In a wide band, where a triangle's share grows with
/// the cube of the reach and hardly any of it stays its own, points far from the surface ask a tree
/// for the nearest triangle instead.
class BandSampler {
 public:
  /// Most points of the bricks: 12 GiB if stored as codes of 24 bits (BrickSamples).
  static constexpr Index kMaxPoints = Index(1) << 32;
  /// Most points if stored as floats (SparseLattice): 8 GiB.
  static constexpr Index kMaxFloatPoints = Index(1) << 31;

  /// \param surface      must outlive the sampler.
  /// \param reach_mm     points up to this far from the surface are sampled.
  /// \param max_points  of the lattice, in all bricks.
  /// \returns kInvalidArgument if the band takes more points than that, or brings too many
  ///   triangles together with bricks; kCancelled.
  [[nodiscard]] static Result<BandSampler> create(const PreparedSurface& surface,
                                                  const FieldFrame& frame, double reach_mm,
                                                  Index max_points = kMaxPoints,
                                                  Progress& progress = Progress::none(),
                                                  Simd simd = best_simd());

  /// Numbers of the bricks that a triangle reaches (SparseLattice), ascending. Some may turn out to
  /// hold no sample.
  [[nodiscard]] std::span<const std::int32_t> bricks() const { return bricks_; }

  /// Signed distances [mm] at the points of a brick, kUnsampled beyond the reach; and their signs.
  ///
  /// The nearest triangle is found in single precision; the sign is that of the pseudonormal at its
  /// nearest feature.
  ///
  /// \param slot  position in bricks().
  BrickSigns sample(Index slot, std::span<float, SparseLattice::kBrickPoints> distances) const;

 private:
  BandSampler(const PreparedSurface& surface, const FieldFrame& frame, double reach_mm, Simd simd);

  [[nodiscard]] Result<void> bin_triangles();
  [[nodiscard]] Result<void> grow_band_by_tree(Index max_bricks, Progress& progress);
  void find_nearest_triangles(Index slot, const Vec3& low, NearestInBrick& nearest) const;
  [[nodiscard]] bool is_inside(std::int32_t code, const Vec3& p) const;

  const PreparedSurface* surface_;
  Vec3 origin_;
  double cell_mm_;
  int resolution_;
  double reach_mm_;
  double near_mm_;  ///< Up to here triangles are binned; the whole reach, or `far_` has the rest.
  Simd simd_;
  std::vector<std::int32_t> bricks_;
  std::vector<std::uint32_t> first_;     ///< Of the triangles of each brick, and their end.
  std::vector<std::int32_t> triangles_;  ///< By brick, ascending.
  std::optional<TriangleTree> far_;
};

/// Samples every lattice point within `reach_mm` of the surface; the other points of the bricks
/// touched are kUnsampled.
///
/// \param winding  of the surface, or null if it is open: settles contradictions
///   (resolve_sign_conflicts.h).
/// \returns kInvalidArgument if the points would not fit in memory; kCancelled.
[[nodiscard]] Result<SparseLattice> sample_narrow_band(const PreparedSurface& surface,
                                                       const FieldFrame& frame, double reach_mm,
                                                       const WindingScanlines* winding,
                                                       Progress& progress);

}  // namespace lefort::field
