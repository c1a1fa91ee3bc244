#include <lefort/anatomy/extract_surface.h>
#include <lefort/core/parallel.h>
#include <lefort/dental/blocked_space.h>
#include <lefort/dental/column_map.h>
#include <lefort/dental/cutting_guide.h>
#include <lefort/geometry/mesh_properties.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace lefort::dental {
namespace {

using geometry::Bvh;
using geometry::TriangleMesh;

/// A slot: positions along the line between which the saw has space.
struct Slot {
  double first_mm, last_mm;
};

std::vector<Slot> slots_of(const CutLine& line, const GuideOptions& options) {
  const double first = line.first_mm() + options.bridge_mm;
  const double length = line.last_mm() - options.bridge_mm - first;
  if (length <= 0.0) return {};
  const double step = options.max_slot_mm + options.bridge_mm;
  const int count = std::max(1, int(std::ceil((length + options.bridge_mm) / step)));
  const double slot_mm = (length - (count - 1) * options.bridge_mm) / count;
  std::vector<Slot> slots;
  for (int n = 0; n < count; ++n) {
    const double at = first + n * (slot_mm + options.bridge_mm);
    slots.push_back({at, at + slot_mm});
  }
  return slots;
}

/// Closest point of the line.
struct NearLine {
  double distance_mm, position_mm;
};

NearLine near_line(const CutLine& line, const Vec3& p_L) {
  const auto closest = std::min_element(line.points_L.begin(), line.points_L.end(),
                                        [&](const Vec3& a, const Vec3& b) {
                                          return (a - p_L).squaredNorm() < (b - p_L).squaredNorm();
                                        });
  return {(*closest - p_L).norm(), line.position_mm(*closest)};
}

/// Level-set functions of what is removed from the body of a guide: positive where material stays.
class Openings {
 public:
  Openings(const GuideSite& site, const CutLine& line, std::span<const GuideHole> holes,
           double diameter_mm, const GuideOptions& options)
      : site_(site),
        holes_(holes),
        radius_mm_(0.5 * diameter_mm),
        half_slot_mm_(0.5 * site.saw_mm + options.slot_clearance_mm),
        slots_(slots_of(line, options)) {}

  [[nodiscard]] double at(const Vec3& p_L, double position_mm) const {
    double along_mm = std::numeric_limits<double>::infinity();  // From the closest slot.
    for (const Slot& slot : slots_)
      along_mm =
          std::min(along_mm, std::max(slot.first_mm - position_mm, position_mm - slot.last_mm));
    double level = std::max(along_mm, 0.0) > half_slot_mm_
                       ? along_mm
                       : std::max(along_mm, std::abs(site_.from_cut_mm(p_L) - 0.5 * site_.saw_mm) -
                                                half_slot_mm_);
    for (const GuideHole& hole : holes_) {
      const Vec3 from = p_L - hole.point_L;
      level = std::min(level, (from - from.dot(hole.axis_L) * hole.axis_L).norm() - radius_mm_);
    }
    return level;
  }
  [[nodiscard]] double slot_mm() const {
    double sum = 0.0;
    for (const Slot& slot : slots_) sum += slot.last_mm - slot.first_mm;
    return sum;
  }
  [[nodiscard]] double slot_width_mm() const { return 2.0 * half_slot_mm_; }

 private:
  const GuideSite& site_;
  std::span<const GuideHole> holes_;
  double radius_mm_, half_slot_mm_;
  std::vector<Slot> slots_;
};

/// The grid around the line: i along it, k outward.
Result<image::Grid> grid_around(const GuideSite& site, const CutLine& line,
                                const GuideOptions& options) {
  image::Grid grid;
  grid.direction << line.along_L, site.outward_L.cross(line.along_L), site.outward_L;
  Box3 box;
  for (const Vec3& p : line.points_L) box.extend(Vec3(grid.direction.transpose() * p));
  const double margin_mm =
      options.width_mm + options.thickness_mm + options.clearance_mm + 3.0 * options.voxel_mm;
  box.min() -= Vec3::Constant(margin_mm);
  box.max() += Vec3::Constant(margin_mm);
  return grid_in_box(grid.direction, box, options.voxel_mm);
}

/// Positive where the bone of a column faces outward (75 degrees or less) [mm], so that no guide
/// hooks around edges, as that of the nasal aperture.
ColumnMap facing(const BlockedSpace& blocked) {
  constexpr double kCosine = 0.26, kScale_mm = 3.0, kSmooth_mm = 1.0;
  const image::Grid& grid = blocked.level.grid;
  const ColumnMap heights =
      smoothed({grid.size[0], grid.size[1], grid.spacing_mm.x(), blocked.border_mm}, kSmooth_mm);
  ColumnMap faces = heights;
  const double step_mm = 2.0 * heights.spacing_mm;
  parallel_for(heights.width * heights.height, [&](Index column) {
    const Index i = column % heights.width, j = column / heights.width;
    double cosine = 0.0;
    if (i > 0 && j > 0 && i + 1 < heights.width && j + 1 < heights.height) {
      const double du = (heights.at(i + 1, j) - heights.at(i - 1, j)) / step_mm;
      const double dv = (heights.at(i, j + 1) - heights.at(i, j - 1)) / step_mm;
      if (!std::isnan(du + dv)) cosine = 1.0 / std::sqrt(1.0 + du * du + dv * dv);
    }
    faces.values[std::size_t(column)] = kScale_mm * (cosine - kCosine);
  });
  return smoothed(faces, kSmooth_mm);
}

/// Level of the guide. Takes the place of that of the blocked space.
image::ScalarVolume guide_level(BlockedSpace&& blocked, const GuideSite& site, const CutLine& line,
                                const Openings& openings, const GuideOptions& options,
                                const Progress& progress) {
  const ColumnMap faces = facing(blocked);
  image::ScalarVolume level = std::move(blocked.level);
  const image::Grid& grid = level.grid;
  const double outer_mm = options.clearance_mm + options.thickness_mm;
  parallel_for(grid.size[1] * grid.size[2], [&](Index row) {
    if (progress.stop_requested()) return;
    const Index j = row % grid.size[1], k = row / grid.size[1];
    for (Index i = 0; i < grid.size[0]; ++i) {
      float& value = level.at(i, j, k);
      const bool is_outermost = i == 0 || j == 0 || k == 0 || i + 1 == grid.size[0] ||
                                j + 1 == grid.size[1] || k + 1 == grid.size[2];
      const Vec3 p_L =
          grid.point_L({static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
      const double free_mm = -static_cast<double>(value);
      value = -1.0F;
      if (is_outermost || free_mm < -1.0) continue;
      const auto bone = site.bone.closest_point(p_L, outer_mm + 2.0 * options.voxel_mm);
      if (!bone) continue;
      const NearLine near = near_line(line, p_L);
      const double body = std::min({free_mm, outer_mm - bone->distance_mm,
                                    options.width_mm - near.distance_mm, faces.at(i, j)});
      value = float(body < -1.0 ? -1.0 : std::min(body, openings.at(p_L, near.position_mm)));
    }
  });
  return level;
}

/// Vertices of the bone that the guide covers, not below openings.
std::vector<char> under_guide(const GuideSite& site, const BlockedSpace& blocked,
                              const CutLine& line, const Openings& openings,
                              const GuideOptions& options) {
  constexpr double kFaces = 0.5, kMargin_mm = 1.0, kDeep_mm = 0.5;
  const TriangleMesh& mesh = site.bone.mesh();
  const image::Grid& grid = blocked.level.grid;
  std::vector<char> covered(mesh.vertices.size(), 0);
  parallel_for(mesh.vertex_count(), [&](Index v) {
    const Vec3& p_L = mesh.vertices[std::size_t(v)];
    const Vec3 at = grid.index_V(p_L);
    const auto i = Index(std::lround(at.x())), j = Index(std::lround(at.y()));
    if (!grid.contains(i, j, 0)) return;
    const double border_mm = blocked.border_mm[std::size_t(i + grid.size[0] * j)];
    if (!(border_mm - at.z() * grid.spacing_mm.z() <= options.clearance_mm + kDeep_mm)) return;
    if (site.bone.pseudonormals().at_vertex(mesh, v).dot(site.outward_L) < kFaces) return;
    const NearLine near = near_line(line, p_L);
    if (near.distance_mm < options.width_mm - kMargin_mm &&
        openings.at(p_L, near.position_mm) > kMargin_mm)
      covered[std::size_t(v)] = 1;
  });
  return covered;
}

/// The surface, without parts that are much smaller than the largest one, as on the edge of a hole
/// in thin bone.
Result<TriangleMesh> surface_of(const image::ScalarVolume& level, Progress& progress) {
  constexpr double kMinPart_ml = 0.01, kMinRatio = 0.2;
  auto surface_L = anatomy::extract_isosurface(level, {kMinPart_ml}, progress);
  if (!surface_L) {
    if (surface_L.error().code != ErrorCode::kMeshInvalid) return surface_L;
    return fail(ErrorCode::kMeshInvalid, "there is no space for a guide on this line");
  }
  double max_mm3 = 0.0;
  const auto volume = [](const TriangleMesh& part) { return geometry::signed_volume_mm3(part); };
  static_cast<void>(geometry::keep_components(*surface_L, [&](const TriangleMesh& part) {
    max_mm3 = std::max(max_mm3, volume(part));
    return false;
  }));
  return geometry::keep_components(
      *surface_L, [&](const TriangleMesh& part) { return volume(part) > kMinRatio * max_mm3; });
}

}  // namespace

Result<void> check_guide(const GuideOptions& o) {
  const auto in = [](double value, double low, double high) {
    return value >= low && value <= high;
  };
  if (in(o.clearance_mm, 0.0, 0.5) && in(o.thickness_mm, 2.0, 6.0) && in(o.width_mm, 5.0, 20.0) &&
      in(o.slot_clearance_mm, 0.0, 0.5) && in(o.bridge_mm, 2.0, 10.0) &&
      in(o.max_slot_mm, 5.0, 100.0) && in(o.voxel_mm, 0.1, 0.5))
    return {};
  return fail(ErrorCode::kInvalidArgument,
              fmt::format("clearance {} mm, thickness {} mm, width {} mm, slot clearance {} mm, "
                          "bridge {} mm, slot {} mm, voxel {} mm: must be 0 to 0.5, 2 to 6, 5 to "
                          "20, 0 to 0.5, 2 to 10, 5 to 100, 0.1 to 0.5",
                          o.clearance_mm, o.thickness_mm, o.width_mm, o.slot_clearance_mm,
                          o.bridge_mm, o.max_slot_mm, o.voxel_mm));
}

Result<Guide> make_guide(const GuideSite& site, const CutLine& line,
                         std::span<const GuideHole> holes, double diameter_mm,
                         const GuideOptions& options, Progress& progress) {
  LEFORT_TRY_VOID(check_guide(options));
  LEFORT_TRY(const image::Grid grid, grid_around(site, line, options));
  progress.begin_stage("space of the bone");
  BlockedSpace blocked = block_space(site.bone, grid, false, options.clearance_mm, progress);
  const Openings openings(site, line, holes, diameter_mm, options);
  progress.begin_stage("body of the guide");
  const std::vector<char> covered = under_guide(site, blocked, line, openings, options);
  const image::ScalarVolume level =
      guide_level(std::move(blocked), site, line, openings, options, progress);
  if (progress.stop_requested()) return fail(ErrorCode::kCancelled, "the guide was cancelled");
  Guide guide;
  LEFORT_TRY(guide.surface_L, surface_of(level, progress));
  guide.parts = geometry::connected_components(guide.surface_L).count;
  guide.volume_ml = 1e-3 * geometry::signed_volume_mm3(guide.surface_L);
  guide.slot_mm = openings.slot_mm();
  guide.slot_width_mm = openings.slot_width_mm();
  progress.begin_stage("fit of the guide");
  guide.fit =
      insertion_fit(site.bone.mesh(), Bvh(guide.surface_L), covered, site.outward_L, progress);
  if (progress.stop_requested()) return fail(ErrorCode::kCancelled, "the guide was cancelled");
  return guide;
}

}  // namespace lefort::dental
