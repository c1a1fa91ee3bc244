#include <lefort/core/parallel.h>
#include <lefort/field/feature_regions.h>
#include <lefort/field/narrow_band.h>
#include <lefort/geometry/pseudonormals.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace lefort::field {

namespace {

constexpr int kSide = SparseLattice::kSide;
/// Share of a cell by which regions are widened against rounding.
constexpr double kSlack = 1e-6;
constexpr Index kMaxLatticePoints = Index(1) << 28;
constexpr Index kProgressSteps = 20;

/// Bricks low to high, both included.
struct BrickRange {
  LatticePoint low, high;
};

/// A feature to be visited in a brick.
struct Visit {
  std::int32_t brick;
  std::int32_t feature;
};

/// The lattice as seen by the sampler: regions come in mm, lattice points in counts.
struct Lattice {
  Vec3 origin;
  double cell;
  int bricks_per_side;

  [[nodiscard]] Vec3 position(const LatticePoint& p) const {
    return origin + cell * Vec3(p[0], p[1], p[2]);
  }
  [[nodiscard]] int brick_at(double coordinate, int axis) const {
    const int point = int(std::floor((coordinate - origin[axis]) / cell)) + kSide;
    return std::clamp(point / kSide, 0, bricks_per_side - 1);
  }
};

bool misses(std::span<const HalfSpace> half_spaces, const Vec3& centre, const Vec3& half_size) {
  return std::any_of(half_spaces.begin(), half_spaces.end(), [&](const HalfSpace& h) {
    return h.normal.dot(centre) - h.normal.cwiseAbs().dot(half_size) > h.offset;
  });
}

/// Halves the range until bricks are alone, dropping what the region does not reach.
void visit_bricks(const Lattice& lattice, std::span<const HalfSpace> half_spaces,
                  const BrickRange& range, std::int32_t feature, std::vector<Visit>& visits) {
  Vec3 centre, half_size;
  int widest = 0;
  for (int k = 0; k < 3; ++k) {
    const auto axis = std::size_t(k);
    const int points = (range.high[axis] - range.low[axis] + 1) * kSide - 1;
    half_size[k] = 0.5 * lattice.cell * points;
    centre[k] = lattice.origin[k] + lattice.cell * (range.low[axis] * kSide - kSide) + half_size[k];
    if (half_size[k] > half_size[widest]) widest = k;
  }
  if (misses(half_spaces, centre, half_size)) return;
  const auto split = std::size_t(widest);
  if (range.low[split] == range.high[split]) {
    const int n = lattice.bricks_per_side;
    visits.push_back({(range.low[2] * n + range.low[1]) * n + range.low[0], feature});
    return;
  }
  BrickRange first = range, second = range;
  first.high[split] = (range.low[split] + range.high[split]) / 2;
  second.low[split] = first.high[split] + 1;
  visit_bricks(lattice, half_spaces, first, feature, visits);
  visit_bricks(lattice, half_spaces, second, feature, visits);
}

/// Visits by brick: those of brick number b are [first[b], first[b + 1]), features ascending.
struct VisitsByBrick {
  std::vector<std::size_t> first;
  std::vector<std::int32_t> features;
};

VisitsByBrick plan_visits(const Lattice& lattice, const FeatureRegions& regions) {
  const auto visits =
      parallel_collect<Visit>(regions.count(), [&](Index feature, std::vector<Visit>& list) {
        const FeatureRegion& region = regions[feature];
        BrickRange range{};
        for (int k = 0; k < 3; ++k) {
          range.low[std::size_t(k)] = lattice.brick_at(region.box.min()[k], k);
          range.high[std::size_t(k)] = lattice.brick_at(region.box.max()[k], k);
        }
        visit_bricks(lattice, regions.half_spaces_of(region), range, std::int32_t(feature), list);
      });
  const auto n = std::size_t(lattice.bricks_per_side);
  VisitsByBrick sorted;
  sorted.first.assign(n * n * n + 1, 0);
  for (const Visit& visit : visits) ++sorted.first[std::size_t(visit.brick) + 1];
  for (std::size_t b = 1; b < sorted.first.size(); ++b) sorted.first[b] += sorted.first[b - 1];
  std::vector<std::size_t> next(sorted.first.begin(), sorted.first.end() - 1);
  sorted.features.resize(visits.size());
  for (const Visit& visit : visits)
    sorted.features[next[std::size_t(visit.brick)]++] = visit.feature;
  return sorted;
}

/// The nearest feature so far at each point of a brick.
class BrickSampler {
 public:
  BrickSampler(const Lattice& lattice, const LatticePoint& first_point, double reach)
      : cell_(lattice.cell), low_(lattice.position(first_point)) {
    squared_.fill(reach * reach);
    inside_.fill(false);
    reached_.fill(false);
  }

  void visit(const FeatureRegion& region, std::span<const HalfSpace> half_spaces) {
    LatticePoint begin{}, end{};
    for (int k = 0; k < 3; ++k) {
      const auto axis = std::size_t(k);
      begin[axis] = std::clamp(int(std::ceil((region.box.min()[k] - low_[k]) / cell_)), 0, kSide);
      end[axis] =
          std::clamp(int(std::floor((region.box.max()[k] - low_[k]) / cell_)) + 1, 0, kSide);
    }
    planes_.clear();
    for (const HalfSpace& h : half_spaces)
      planes_.emplace_back(h.normal.dot(low_) - h.offset, cell_ * h.normal, begin, end);
    for (int k = begin[2]; k < end[2]; ++k) {
      const auto misses_slab = [k](const Plane& plane) {
        return plane.least_in_slab + k * plane.step.z() > 0.0;
      };
      if (std::any_of(planes_.begin(), planes_.end(), misses_slab)) continue;
      for (int j = begin[1]; j < end[1]; ++j) visit_row(region, j, k, begin[0], end[0] - 1);
    }
  }

  void write(std::span<float, SparseLattice::kBrickPoints> values) const {
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!reached_[i]) continue;
      const auto distance = float(std::sqrt(squared_[i]));
      values[i] = inside_[i] ? -distance : distance;
    }
  }

 private:
  /// A half-space in lattice steps from low_: excess + step . (i, j, k) <= 0.
  struct Plane {
    Plane(double at_low, const Vec3& per_step, const LatticePoint& begin, const LatticePoint& end)
        : excess(at_low), step(per_step), inverse_x(1.0 / per_step.x()), least_in_slab(at_low) {
      for (int k = 0; k < 2; ++k)
        least_in_slab +=
            std::min(step[k] * begin[std::size_t(k)], step[k] * (end[std::size_t(k)] - 1));
    }
    double excess;
    Vec3 step;
    double inverse_x;
    double least_in_slab;  ///< Least value over the points visited with k = 0.
  };

  /// The points of a row inside a convex region are consecutive.
  void visit_row(const FeatureRegion& region, int j, int k, double from, double to) {
    for (const Plane& plane : planes_) {
      const double excess = plane.excess + j * plane.step.y() + k * plane.step.z();
      if (plane.step.x() > 0.0) {
        to = std::min(to, -excess * plane.inverse_x);
      } else if (plane.step.x() < 0.0) {
        from = std::max(from, -excess * plane.inverse_x);
      } else if (excess > 0.0) {
        return;
      }
      if (!(from <= to)) return;
    }
    const Vec3 start = low_ + cell_ * Vec3(0, j, k);
    for (int i = int(std::ceil(from)); i <= int(std::floor(to)); ++i)
      visit_point(region, start + Vec3(cell_ * i, 0, 0), std::size_t((k * kSide + j) * kSide + i));
  }

  void visit_point(const FeatureRegion& region, const Vec3& p, std::size_t place) {
    const Vec3 from_anchor = p - region.anchor;
    const double along = region.axis.dot(from_anchor);
    double squared = 0.0;
    Vec3 from_nearest = from_anchor;
    switch (region.kind) {
      case FeatureKind::kFace:
        squared = along * along;
        from_nearest = along * region.axis;
        break;
      case FeatureKind::kEdge:
        from_nearest -= along * region.axis;
        squared = from_nearest.squaredNorm();
        break;
      case FeatureKind::kVertex:
        squared = from_anchor.squaredNorm();
        break;
    }
    if (squared >= squared_[place]) return;
    squared_[place] = squared;
    inside_[place] = region.pseudonormal.dot(from_nearest) < 0.0;
    reached_[place] = true;
  }

  double cell_;
  Vec3 low_;
  std::vector<Plane> planes_;  ///< Of the region being visited.
  std::array<double, SparseLattice::kBrickPoints> squared_;
  std::array<bool, SparseLattice::kBrickPoints> inside_;
  std::array<bool, SparseLattice::kBrickPoints> reached_;
};

}  // namespace

Result<SparseLattice> sample_narrow_band(const geometry::TriangleMesh& mesh,
                                         const FieldFrame& frame, double reach_mm,
                                         Progress& progress) {
  const Lattice lattice{frame.origin_B, frame.cell_mm,
                        SparseLattice::bricks_per_side(frame.resolution)};
  const geometry::Pseudonormals normals = geometry::compute_pseudonormals(mesh);
  const FeatureRegions regions(mesh, normals, reach_mm, kSlack * frame.cell_mm);
  if (progress.stop_requested()) return fail(ErrorCode::kCancelled, "the field was not finished");
  const VisitsByBrick visits = plan_visits(lattice, regions);

  std::vector<std::int32_t> bricks;
  for (std::size_t b = 0; b + 1 < visits.first.size(); ++b)
    if (visits.first[b] != visits.first[b + 1]) bricks.push_back(std::int32_t(b));
  if (Index(bricks.size()) * SparseLattice::kBrickPoints > kMaxLatticePoints)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("the band holds {} lattice points, at most {} are possible; lower the "
                            "resolution or the band",
                            bricks.size() * SparseLattice::kBrickPoints, kMaxLatticePoints));

  SparseLattice distances(frame.resolution, std::move(bricks), kFar);
  const Index count = distances.brick_count();
  for (Index step = 0; step < kProgressSteps; ++step) {
    const Index begin = count * step / kProgressSteps, end = count * (step + 1) / kProgressSteps;
    if (progress.stop_requested()) return fail(ErrorCode::kCancelled, "the field was not finished");
    const auto sample_brick = [&](Index offset) {
      const Index slot = begin + offset;
      const auto brick = std::size_t(distances.brick_number(slot));
      BrickSampler sampler(lattice, distances.first_point(std::int32_t(brick)), reach_mm);
      for (std::size_t v = visits.first[brick]; v < visits.first[brick + 1]; ++v) {
        const FeatureRegion& region = regions[visits.features[v]];
        sampler.visit(region, regions.half_spaces_of(region));
      }
      sampler.write(distances.brick(slot));
    };
    parallel_for(end - begin, sample_brick, 4);
    progress.report(double(step + 1) / kProgressSteps);
  }
  return distances;
}

}  // namespace lefort::field
