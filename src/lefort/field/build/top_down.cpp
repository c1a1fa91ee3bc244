#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/field/build/top_down.h>
#include <lefort/field/storage/octree_cells.h>
#include <lefort/geometry/bvh.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

namespace lefort::field {

namespace {

/// Cubes up to this size are processed by one thread each, with their own samples.
constexpr int kCubeCells = 16;
constexpr int kCubePoints = kCubeCells + 1;

class Lattice {
 public:
  Lattice(const PreparedSurface& surface, const geometry::Bvh& bvh, const FieldFrame& frame,
          const WindingScanlines* winding)
      : surface_(surface), bvh_(bvh), frame_(frame), winding_(winding) {}

  /// As SignedDistances::at().
  [[nodiscard]] float value(const LatticePoint& p) const {
    // As for the other methods: a float, and the edge of the band is beyond the band.
    const auto d = float(exact(p));
    return std::abs(d) < float(frame_.band_mm) ? d : zone_value(zone_outside_band(p));
  }

  /// Zone of a cube that contains no point of the band; nothing otherwise. \pre cells is even.
  [[nodiscard]] std::optional<Zone> zone_of_cube(const LatticePoint& low, int cells) const {
    const LatticePoint center = {low[0] + cells / 2, low[1] + cells / 2, low[2] + cells / 2};
    const double half_diagonal_mm = 0.5 * std::numbers::sqrt3 * cells * frame_.cell_mm;
    if (std::abs(exact(center)) - half_diagonal_mm <= frame_.band_mm) return std::nullopt;
    return zone_outside_band(center);
  }

  [[nodiscard]] const FieldFrame& frame() const { return frame_; }

 private:
  /// Exact distance with the sign of the closest feature; both sides of opposite duplicates are
  /// outside.
  [[nodiscard]] double exact(const LatticePoint& lattice_point) const {
    const Vec3 p = frame_.origin_B +
                   frame_.cell_mm * Vec3(lattice_point[0], lattice_point[1], lattice_point[2]);
    const geometry::SignedDistance found = bvh_.signed_distance(p);
    const bool on_opposite_duplicate =
        !surface_.is_opposite_duplicate.empty() &&
        surface_.is_opposite_duplicate[std::size_t(found.nearest.triangle)] &&
        found.nearest.feature == geometry::Feature::kFace;
    if (on_opposite_duplicate) return found.nearest.distance_mm;
    // Where the surface intersects itself, the sign of the closest feature may be wrong.
    if (winding_ != nullptr && found.nearest.distance_mm > frame_.cell_mm)
      return winding_->is_inside(lattice_point) ? -found.nearest.distance_mm
                                                : found.nearest.distance_mm;
    return found.distance_mm;
  }
  [[nodiscard]] Zone zone_outside_band(const LatticePoint& p) const {
    if (winding_ == nullptr) return Zone::kUnknown;
    return winding_->is_inside(p) ? Zone::kInside : Zone::kOutside;
  }

  const PreparedSurface& surface_;
  const geometry::Bvh& bvh_;
  const FieldFrame& frame_;
  const WindingScanlines* winding_;
};

/// A cube of at most kCubeCells with the samples computed so far.
class Cube {
 public:
  Cube(const Lattice& lattice, const LatticePoint& low, std::string& codes)
      : lattice_(lattice),
        low_(low),
        codes_(codes),
        values_(std::size_t(kCubePoints * kCubePoints * kCubePoints), kNotRequested) {}

  void split(const LatticePoint& low, int cells) {
    const auto value_at = [this](const LatticePoint& p) { return value(p); };
    if (const auto zone = lattice_.zone_of_cube(low, cells)) {
      codes_ += char(code_of(*zone));
    } else if (corners_reproduce(value_at, low, cells, lattice_.frame().tolerance_mm) &&
               !has_conflict(value_at, low, cells, float(lattice_.frame().cell_mm))) {
      codes_ += char(NodeCode::kBand);
    } else {
      codes_ += char(NodeCode::kBranch);
      if (cells == 2) {
        append_fine_cells(codes_,
                          classify_fine_cells(value_at, low, float(lattice_.frame().cell_mm)));
      } else {
        for (int child = 0; child < 8; ++child)
          split(corner_point(low, child, cells / 2), cells / 2);
      }
    }
  }

 private:
  static constexpr float kNotRequested = -std::numeric_limits<float>::max();

  float value(const LatticePoint& p) {
    float& value = values_[std::size_t(
        ((p[2] - low_[2]) * kCubePoints + p[1] - low_[1]) * kCubePoints + p[0] - low_[0])];
    if (value == kNotRequested) value = lattice_.value(p);
    return value;
  }

  const Lattice& lattice_;
  LatticePoint low_;
  std::string& codes_;
  std::vector<float> values_;
};

/// Splits cubes larger than kCubeCells. Lattice points are recomputed, because there are few.
void split_upper(const Lattice& lattice, const std::vector<std::string>& cubes,
                 const LatticePoint& low, int cells, std::string& codes) {
  if (cells == kCubeCells) {
    const int n = lattice.frame().resolution / kCubeCells;
    codes += cubes[std::size_t((low[2] / kCubeCells * n + low[1] / kCubeCells) * n +
                               low[0] / kCubeCells)];
    return;
  }
  if (const auto zone = lattice.zone_of_cube(low, cells)) {
    codes += char(code_of(*zone));
    return;
  }
  const auto value_at = [&](const LatticePoint& p) { return lattice.value(p); };
  if (corners_reproduce(value_at, low, cells, lattice.frame().tolerance_mm) &&
      !has_conflict(value_at, low, cells, float(lattice.frame().cell_mm))) {
    codes += char(NodeCode::kBand);
    return;
  }
  codes += char(NodeCode::kBranch);
  for (int child = 0; child < 8; ++child)
    split_upper(lattice, cubes, corner_point(low, child, cells / 2), cells / 2, codes);
}

}  // namespace

Result<Octree> split_top_down(const PreparedSurface& surface, const FieldFrame& frame,
                              const WindingScanlines* winding, Progress& progress) {
  const geometry::Bvh bvh(surface.mesh_B);
  const Lattice lattice(surface, bvh, frame, winding);
  const int n = frame.resolution / kCubeCells;
  std::vector<std::string> cubes(std::size_t(n) * std::size_t(n) * std::size_t(n));
  // One slice of cubes at a time, so that progress can be reported.
  for (int slice = 0; slice < n; ++slice) {
    if (progress.stop_requested()) return fail(ErrorCode::kCancelled, "the field was not finished");
    parallel_for(
        Index(n) * n,
        [&](Index b) {
          const LatticePoint low = {int(b % n) * kCubeCells, int(b / n) * kCubeCells,
                                    slice * kCubeCells};
          Cube(lattice, low, cubes[std::size_t(Index(slice) * n * n + b)]).split(low, kCubeCells);
        },
        1);
    progress.report(double(slice + 1) / n);
  }
  std::string codes;
  split_upper(lattice, cubes, {0, 0, 0}, frame.resolution, codes);
  LEFORT_TRY(Octree octree, Octree::decode(frame.resolution, codes));
  const std::vector<LatticePoint> points = octree.sample_points();
  parallel_for(Index(points.size()), [&](Index s) {
    octree.samples()[std::size_t(s)] = lattice.value(points[std::size_t(s)]);
  });
  return octree;
}

}  // namespace lefort::field
