/// \file
/// Signed distances at the lattice points near a surface, brick by brick (paper, section 2.1, steps
/// 1 to 3).
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

/// Value of a lattice point without a sample, before its zone is known.
inline constexpr float kUnsampled = std::numeric_limits<float>::quiet_NaN();

/// Assigns triangles to bricks, and samples bricks one at a time, in any order and from any thread.
///
/// The paper extrudes each triangle to a prism of +-band and visits the lattice points in the box
/// of the prism. Prisms leave gaps, wedges at convex edges and cones at convex corners, which the
/// boxes cover only by chance. Here the region of a triangle is bounded by its box, its plane and
/// its edges, all extended by the max distance (triangle_brick_overlaps.h), which leaves no gap.
/// The volume of this region grows with the cube of the distance, and most points in it are closer
/// to other triangles. In a band of more than 6 cells a tree therefore finds the nearest triangle
/// of points further than 3 cells from the surface.
class BandSampler {
 public:
  /// Max points of the bricks if stored as codes of 24 bits (BrickSamples): 12 GiB.
  static constexpr Index kMaxPoints = Index(1) << 32;
  /// Max points if stored as floats (SparseLattice): 8 GiB.
  static constexpr Index kMaxFloatPoints = Index(1) << 31;

  /// Finds the bricks of a band.
  ///
  /// \param surface          must outlive the sampler.
  /// \param frame            lattice of the field.
  /// \param max_distance_mm  points up to this distance from the surface are sampled.
  /// \param max_points       max number of lattice points of all bricks.
  /// \param progress         may cancel.
  /// \param simd             instruction set; all give the same bits.
  /// \returns the sampler; kInvalidArgument if the band contains more points, or there are too many
  ///   pairs of a triangle and a brick; or kCancelled.
  [[nodiscard]] static Result<BandSampler> create(const PreparedSurface& surface,
                                                  const FieldFrame& frame, double max_distance_mm,
                                                  Index max_points = kMaxPoints,
                                                  Progress& progress = Progress::none(),
                                                  Simd simd = best_simd());

  /// Numbers of the bricks of the band (SparseLattice), ascending. Some may contain no sample.
  [[nodiscard]] std::span<const std::int32_t> bricks() const { return bricks_; }

  /// Computes the signed distances [mm] at the points of a brick, and their signs.
  ///
  /// The nearest triangle is found in single precision; the sign is that of the pseudonormal at the
  /// closest feature.
  ///
  /// \param slot       position in bricks().
  /// \param distances  kUnsampled beyond the max distance.
  [[nodiscard]] BrickSigns sample(Index slot,
                                  std::span<float, SparseLattice::kBrickPoints> distances) const;

 private:
  BandSampler(const PreparedSurface& surface, const FieldFrame& frame, double max_distance_mm,
              Simd simd);

  [[nodiscard]] Result<void> bin_triangles();
  [[nodiscard]] Result<void> grow_band_by_tree(Index max_bricks, Progress& progress);
  void find_nearest_triangles(Index slot, const Vec3& low, NearestInBrick& nearest) const;
  [[nodiscard]] bool is_inside(std::int32_t code, const Vec3& p) const;

  const PreparedSurface* surface_;
  Vec3 origin_;
  double cell_mm_;
  int resolution_;
  double max_distance_mm_;
  /// Up to this distance triangles are assigned to bricks. If it is less than max_distance_mm_,
  /// `tree_` is used for points further away.
  double binned_mm_;
  Simd simd_;
  std::vector<std::int32_t> bricks_;
  std::vector<std::uint32_t> first_;     ///< Offset of each brick in triangles_; one more, the end.
  std::vector<std::int32_t> triangles_;  ///< By brick, ascending.
  std::optional<TriangleTree> tree_;
};

/// Resolves the sign conflicts of a sampled brick, if the surface is closed.
///
/// \param distances  of BandSampler::sample().
/// \param signs      of `distances`.
/// \param winding    of the surface, or null if it is open.
/// \param brick      number of the brick.
/// \param frame      lattice of the field.
void resolve_by_winding(std::span<float, SparseLattice::kBrickPoints> distances, BrickSigns signs,
                        const WindingScanlines* winding, std::int32_t brick,
                        const FieldFrame& frame);

/// Samples every lattice point within `max_distance_mm` of the surface; other points of the same
/// bricks are kUnsampled.
///
/// \param surface          to be sampled.
/// \param frame            lattice of the field.
/// \param max_distance_mm  max distance of samples.
/// \param winding          of the surface, or null if it is open; resolves sign conflicts
///   (resolve_sign_conflicts.h).
/// \param progress         receives the fraction done; may cancel.
/// \returns the samples [mm]; kInvalidArgument as BandSampler::create(), for kMaxFloatPoints; or
///   kCancelled.
[[nodiscard]] Result<SparseLattice> sample_narrow_band(const PreparedSurface& surface,
                                                       const FieldFrame& frame,
                                                       double max_distance_mm,
                                                       const WindingScanlines* winding,
                                                       Progress& progress);

}  // namespace lefort::field
