#include <lefort/core/parallel.h>
#include <lefort/core/trace.h>
#include <lefort/field/build/band_sampler.h>
#include <lefort/field/build/nearest_by_tree.h>
#include <lefort/field/build/triangle_brick_overlaps.h>
#include <lefort/field/internal/bit_masks.h>
#include <lefort/field/sign/outside_band.h>
#include <lefort/field/sign/resolve_sign_conflicts.h>
#include <lefort/field/sign/violates_lipschitz.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

namespace lefort::field {

namespace {

/// Max pairs of a triangle and a brick; each takes twelve bytes.
constexpr std::int64_t kMaxPairs = std::int64_t(1) << 29;
/// Triangles, and bricks, per task.
constexpr Index kTriangleBlock = 1024;
constexpr Index kBrickBlock = 8;
constexpr Index kProgressSteps = 20;
/// In bands wider than kWideCells, points up to kNearCells from the surface are sampled by binned
/// triangles, others with a tree. Values from `lefort bench scaling`.
constexpr double kWideCells = 6.0;
constexpr double kNearCells = 3.0;
/// Distance of BrickSigns::clear_of_surface, with a margin for rounding; less than half of
/// kMaxSlope.
constexpr double kClearCells = 0.5003;
static_assert(2.0 * kClearCells > 1.0 && 2.0 * kClearCells < double(kMaxSlope));
/// Margin of boxes and planes for rounding, as a fraction of a cell.
constexpr double kSlack = 1e-4;

double binned_distance_mm(double max_distance_mm, double cell_mm) {
  return max_distance_mm > kWideCells * cell_mm ? kNearCells * cell_mm : max_distance_mm;
}

/// Signed distances from squared ones: negative below the closest face, kUnsampled without a
/// triangle. Written so that the compiler vectorizes it.
void signed_distances(std::span<const std::int32_t, 64> codes, std::span<float, 64> distances) {
  for (std::size_t i = 0; i < 64; ++i) {
    const std::uint32_t sign = std::uint32_t(codes[i]) << 31;
    const std::uint32_t size = std::bit_cast<std::uint32_t>(std::sqrt(distances[i]));
    distances[i] = codes[i] < 0 ? kUnsampled : std::bit_cast<float>(size | sign);
  }
}

std::uint64_t with_bit(std::uint64_t word, int bit, bool value) {
  return (word & ~(std::uint64_t(1) << bit)) | std::uint64_t(value) << bit;
}

using NearestCodes = std::array<std::int32_t, SparseLattice::kBrickPoints>;

/// Copies codes and distances from tiles into the order of the brick, and takes the signs from the
/// planes of the nearest triangles.
///
/// \param clear_mm      distance from which a point is clear of the surface.
/// \param faces_decide  a plane decides the sign where the closest point is inside a face.
/// \param codes         of the points, x fastest.
/// \param distances     with the signs of the planes.
/// \returns the known points whose sign the planes do not decide.
BrickBits sign_by_faces(const NearestInBrick& nearest, float clear_mm, bool faces_decide,
                        NearestCodes& codes,
                        std::span<float, SparseLattice::kBrickPoints> distances,
                        BrickSigns& signs) {
  BrickBits undecided;
  for (std::size_t z = 0; z < std::size_t(kBrickSide); ++z) {
    const std::span slice_codes = std::span(codes).subspan(64 * z).first<64>();
    const std::span slice = distances.subspan(64 * z).first<64>();
    for (int i = 0; i < 64; i += int(NearestInBrick::kTileX)) {
      const std::size_t from =
          NearestInBrick::linear_offset(i % kBrickSide, i / kBrickSide, int(z));
      std::copy_n(nearest.code.begin() + std::ptrdiff_t(from), NearestInBrick::kTileX,
                  slice_codes.begin() + i);
      std::copy_n(nearest.squared_mm2.begin() + std::ptrdiff_t(from), NearestInBrick::kTileX,
                  slice.begin() + i);
    }
    signs.known[z] = ~internal::top_bits(slice_codes, 0);  // Only kNone is negative.
    const std::uint64_t on_face = internal::top_bits(slice_codes, 31 - NearestInBrick::kFaceBit);
    const std::uint64_t below = internal::top_bits(slice_codes, 31 - NearestInBrick::kBelowBit);
    signs.inside[z] = signs.known[z] & on_face & below;
    signs.clear_of_surface[z] = signs.known[z] & internal::bits_above(slice, clear_mm * clear_mm);
    undecided[z] = signs.known[z] & (faces_decide ? ~on_face : ~std::uint64_t(0));
    signed_distances(slice_codes, slice);
  }
  return undecided;
}

tl::unexpected<Error> too_many_pairs(std::int64_t pairs) {
  return fail(ErrorCode::kInvalidArgument,
              fmt::format("the band has {} pairs of a triangle and a brick, at most "
                          "{} are possible; lower the resolution or the band",
                          pairs, kMaxPairs));
}

tl::unexpected<Error> too_many_points(Index max_bricks) {
  return fail(
      ErrorCode::kInvalidArgument,
      fmt::format("the band contains more than {} points of the lattice; lower the resolution "
                  "or the band",
                  max_bricks * SparseLattice::kBrickPoints));
}

}  // namespace

BandSampler::BandSampler(const PreparedSurface& surface, const FieldFrame& frame,
                         double max_distance_mm, Simd simd)
    : surface_(&surface),
      origin_(frame.origin_B),
      cell_mm_(frame.cell_mm),
      resolution_(frame.resolution),
      max_distance_mm_(max_distance_mm),
      binned_mm_(binned_distance_mm(max_distance_mm, frame.cell_mm)),
      simd_(simd) {}

Result<BandSampler> BandSampler::create(const PreparedSurface& surface, const FieldFrame& frame,
                                        double max_distance_mm, Index max_points,
                                        Progress& progress, Simd simd) {
  const TraceSpan span("find bricks of the band");
  BandSampler sampler(surface, frame, max_distance_mm, simd);
  LEFORT_TRY_VOID(sampler.bin_triangles());
  const Index max_bricks = max_points / SparseLattice::kBrickPoints;
  if (Index(sampler.bricks_.size()) > max_bricks) return too_many_points(max_bricks);
  if (sampler.binned_mm_ < sampler.max_distance_mm_) {
    sampler.tree_ = build_triangle_tree(surface.mesh_B, frame.origin_B);
    LEFORT_TRY_VOID(sampler.grow_band_by_tree(max_bricks, progress));
  }
  return sampler;
}

Result<void> BandSampler::bin_triangles() {
  const geometry::TriangleMesh& mesh = surface_->mesh_B;
  const int n = SparseLattice::bricks_per_side(resolution_);
  const BrickGrid grid = {origin_, cell_mm_, n};
  const double max_distance_mm = binned_mm_ + kSlack * cell_mm_;

  OverlapBudget pairs(kMaxPairs);
  const auto blocks = std::size_t((mesh.triangle_count() + kTriangleBlock - 1) / kTriangleBlock);
  std::vector<TriangleBrickOverlaps> visits(blocks);
  parallel_for_blocks(
      mesh.triangle_count(),
      [&](Index begin, Index end) {
        TriangleBrickOverlaps& block = visits[std::size_t(begin / kTriangleBlock)];
        block = triangle_brick_overlaps(mesh, begin, end, grid, max_distance_mm, pairs, simd_);
        block.bricks.shrink_to_fit();
      },
      kTriangleBlock);
  if (pairs.too_many()) return too_many_pairs(pairs.count());

  std::vector<std::uint32_t> next(std::size_t(n) * std::size_t(n) * std::size_t(n), 0);
  for (const auto& [reached, ends] : visits)
    for (const std::int32_t brick : reached) ++next[std::size_t(brick)];
  std::uint32_t total = 0;
  for (std::size_t b = 0; b < next.size(); ++b) {
    if (next[b] == 0) continue;
    bricks_.push_back(std::int32_t(b));
    first_.push_back(total);
    total += std::exchange(next[b], total);
  }
  first_.push_back(total);
  triangles_.resize(total);
  std::int32_t triangle = 0;
  for (TriangleBrickOverlaps& block : visits) {
    std::uint32_t i = 0;
    for (const std::uint32_t end : block.ends) {
      for (; i < end; ++i) triangles_[next[std::size_t(block.bricks[i])]++] = triangle;
      ++triangle;
    }
    block = {};
  }
  return {};
}

/// Adds bricks in layers from those of the surface outward, as long as a point of the brick may be
/// within the max distance of the surface.
Result<void> BandSampler::grow_band_by_tree(Index max_bricks, Progress& progress) {
  const int n = SparseLattice::bricks_per_side(resolution_);
  const double brick_mm = kBrickSide * cell_mm_;
  // Radius of a brick with all its cells, so that no layer has a gap at a corner.
  const double limit_mm = max_distance_mm_ + 0.5 * std::sqrt(3.0) * brick_mm;
  // One bit per brick of the lattice: 2 MB at the largest resolution.
  std::vector<bool> is_seen(std::size_t(n) * std::size_t(n) * std::size_t(n), false);
  std::vector<std::int32_t> far, front = bricks_;
  for (const std::int32_t b : front) is_seen[std::size_t(b)] = true;
  while (!front.empty()) {
    if (progress.stop_requested()) return fail(ErrorCode::kCancelled, "the field was not finished");
    std::vector<std::int32_t> layer;
    for (const std::int32_t b : front) {
      const std::array<int, 3> at = {b % n, b / n % n, b / (n * n)};
      for (int z = std::max(at[2] - 1, 0); z <= std::min(at[2] + 1, n - 1); ++z)
        for (int y = std::max(at[1] - 1, 0); y <= std::min(at[1] + 1, n - 1); ++y)
          for (int x = std::max(at[0] - 1, 0); x <= std::min(at[0] + 1, n - 1); ++x) {
            const std::int32_t next = (z * n + y) * n + x;
            if (is_seen[std::size_t(next)]) continue;
            is_seen[std::size_t(next)] = true;
            layer.push_back(next);
          }
    }
    const auto keep = [&](Index i, std::vector<std::int32_t>& reached) {
      const std::int32_t b = layer[std::size_t(i)];
      const LatticePoint p = SparseLattice::first_point_of(b, resolution_);
      const Vec3 center =
          origin_ + cell_mm_ * Vec3(p[0], p[1], p[2]) + Vec3::Constant(brick_mm / 2);
      if (std::isfinite(squared_distance(surface_->mesh_B, *tree_, center, limit_mm)))
        reached.push_back(b);
    };
    front = parallel_collect<std::int32_t>(Index(layer.size()), keep);
    far.insert(far.end(), front.begin(), front.end());
    if (Index(far.size() + bricks_.size()) > max_bricks) return too_many_points(max_bricks);
  }
  std::sort(far.begin(), far.end());

  std::vector<std::int32_t> bricks(bricks_.size() + far.size());
  std::merge(bricks_.begin(), bricks_.end(), far.begin(), far.end(), bricks.begin());
  std::vector<std::uint32_t> first;
  std::size_t binned = 0;
  for (const std::int32_t b : bricks) {
    first.push_back(first_[binned]);
    if (binned < bricks_.size() && bricks_[binned] == b) ++binned;
  }
  first.push_back(first_.back());
  bricks_ = std::move(bricks);
  first_ = std::move(first);
  return {};
}

/// True if a point is inside, by the pseudonormal at its closest point.
bool BandSampler::is_inside(std::int32_t code, const Vec3& p) const {
  const geometry::TriangleMesh& mesh = surface_->mesh_B;
  const std::int32_t triangle = NearestInBrick::triangle_of(code);
  if (NearestInBrick::is_face_closest(code))
    return NearestInBrick::is_below(code) &&
           (surface_->is_opposite_duplicate.empty() ||
            !surface_->is_opposite_duplicate[std::size_t(triangle)]);
  const geometry::TrianglePoint nearest = geometry::closest_point_on_triangle(
      p, mesh.corner(triangle, 0), mesh.corner(triangle, 1), mesh.corner(triangle, 2));
  return surface_->normals.at(mesh, triangle, nearest.feature).dot(p - nearest.point) < 0.0;
}

/// Finds the nearest triangle of each point of a brick: among the triangles binned to it, and for
/// points beyond `binned_mm_` in the tree.
void BandSampler::find_nearest_triangles(Index slot, const Vec3& low,
                                         NearestInBrick& nearest) const {
  const geometry::TriangleMesh& mesh = surface_->mesh_B;
  nearest.clear(float(binned_mm_));
  const std::uint32_t first = first_[std::size_t(slot)];
  visit_triangles(mesh, std::span(triangles_).subspan(first, first_[std::size_t(slot) + 1] - first),
                  low, cell_mm_, binned_mm_ + kSlack * cell_mm_, simd_, nearest);
  if (!tree_) return;
  for (std::size_t i = 0; i < nearest.code.size(); ++i)
    if (nearest.code[i] == NearestInBrick::kNone)
      nearest.squared_mm2[i] = float(max_distance_mm_) * float(max_distance_mm_);
  find_nearest(mesh, *tree_, low, cell_mm_, max_distance_mm_, simd_, nearest);
}

BrickSigns BandSampler::sample(Index slot,
                               std::span<float, SparseLattice::kBrickPoints> distances) const {
  const LatticePoint first_point =
      SparseLattice::first_point_of(bricks_[std::size_t(slot)], resolution_);
  const Vec3 low = origin_ + cell_mm_ * Vec3(first_point[0], first_point[1], first_point[2]);
  NearestInBrick nearest;
  find_nearest_triangles(slot, low, nearest);

  const bool has_opposite_duplicates = !surface_->is_opposite_duplicate.empty();
  const auto clear_mm = float(kClearCells * cell_mm_);
  BrickSigns signs;
  NearestCodes codes;
  const BrickBits undecided =
      sign_by_faces(nearest, clear_mm, !has_opposite_duplicates, codes, distances, signs);
  BrickBits to_find = undecided;
  if (surface_->closed && !has_opposite_duplicates) propagate_signs(signs, to_find);
  for (std::size_t z = 0; z < std::size_t(kBrickSide); ++z) {
    for (std::uint64_t left = to_find[z]; left != 0; left &= left - 1) {
      const int bit = std::countr_zero(left);
      const Vec3 p = low + cell_mm_ * Vec3(bit % kBrickSide, bit / kBrickSide, double(z));
      const bool inside = is_inside(codes[64 * z + std::size_t(bit)], p);
      signs.inside[z] = with_bit(signs.inside[z], bit, inside);
    }
    for (std::uint64_t left = undecided[z]; left != 0; left &= left - 1) {
      const int bit = std::countr_zero(left);
      float& distance = distances[64 * z + std::size_t(bit)];
      distance = std::copysign(distance, (signs.inside[z] >> bit & 1) != 0 ? -1.0F : 1.0F);
    }
  }
  return signs;
}

void resolve_by_winding(std::span<float, SparseLattice::kBrickPoints> distances, BrickSigns signs,
                        const WindingScanlines* winding, std::int32_t brick,
                        const FieldFrame& frame) {
  if (winding == nullptr || !signs.any_known()) return;
  resolve_sign_conflicts(distances, signs, inside_with_unsampled(signs, *winding, brick, frame),
                         winding, brick, frame);
}

Result<SparseLattice> sample_narrow_band(const PreparedSurface& surface, const FieldFrame& frame,
                                         double max_distance_mm, const WindingScanlines* winding,
                                         Progress& progress) {
  LEFORT_TRY(
      const BandSampler sampler,
      BandSampler::create(surface, frame, max_distance_mm, BandSampler::kMaxFloatPoints, progress));
  const std::span<const std::int32_t> bricks = sampler.bricks();
  SparseLattice distances(frame.resolution, {bricks.begin(), bricks.end()}, kUnsampled);
  const Index count = distances.brick_count();
  for (Index step = 0; step < kProgressSteps; ++step) {
    const Index begin = count * step / kProgressSteps, end = count * (step + 1) / kProgressSteps;
    if (progress.stop_requested()) return fail(ErrorCode::kCancelled, "the field was not finished");
    parallel_for(
        end - begin,
        [&](Index offset) {
          const Index slot = begin + offset;
          resolve_by_winding(distances.brick(slot), sampler.sample(slot, distances.brick(slot)),
                             winding, bricks[std::size_t(slot)], frame);
        },
        kBrickBlock);
    progress.report(double(step + 1) / kProgressSteps);
  }
  return distances;
}

}  // namespace lefort::field
