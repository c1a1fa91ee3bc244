#include <lefort/anatomy/extract_surface.h>
#include <lefort/anatomy/voxel_mask.h>
#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/field/build/build_distance_field.h>
#include <lefort/geometry/mesh_properties.h>
#include <lefort/image/volume.h>
#include <lefort/mesh/boundary_faces.h>
#include <lefort/predict/regularized_bone.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

namespace lefort::predict {
namespace {

constexpr double kSpacingFraction = 0.25;  // Of the node spacing.
// Of the node spacing. The smoothed edge of a right angle, Phi(x / sigma) Phi(y / sigma) = 1 / 2,
// has the radius of curvature 1.37 sigma, which is then not less than the node spacing.
constexpr double kSigmaFraction = 0.75;
// Of the node spacing. A wall of thickness w recedes by the smoothing: by 0.2 h if w = h, by 0.04 h
// if w = 1.5 h.
constexpr double kWallFraction = 1.5;
// Of the node spacing: two sigma. At a cut, a bone with a collar then recedes by 0.02 h.
constexpr double kCollarFraction = 1.5;
constexpr double kCutFraction = 0.5;        // Of the node spacing: a wider cut is not closed.
constexpr double kMinAgreement = 0.5;       // Cosine between the gradients behind a wall.
constexpr double kMaxBandFraction = 0.4;    // A quarter of the field's cube is the widest band.
constexpr double kMinBandFraction = 0.02;   // Of the tissue's extent: five cells of 256.
constexpr double kNearBand_spacings = 4.0;  // Of the tissue's fine field, beyond a wall.
constexpr int kFarCoarsening = 4;           // Of the tissue's coarse field, which limits the reach.
constexpr double kPadding_sigmas = 4.0;     // Beyond the Gaussian's cutoff.

/// The boundary of the tissue as triangles; nodes of no face are left out.
geometry::TriangleMesh boundary_surface(const mesh::VolumeMesh& tissue) {
  geometry::TriangleMesh surface;
  std::vector<std::int32_t> vertex_of(tissue.nodes_L.size(), -1);
  for (const mesh::Face3& face : mesh::triangles_of(mesh::boundary_faces(tissue))) {
    geometry::Triangle triangle;
    for (std::size_t n = 0; n < 3; ++n) {
      std::int32_t& vertex = vertex_of[std::size_t(face[n])];
      if (vertex < 0) {
        vertex = std::int32_t(surface.vertices.size());
        surface.vertices.push_back(tissue.nodes_L[std::size_t(face[n])]);
      }
      triangle[n] = vertex;
    }
    surface.triangles.push_back(triangle);
  }
  return surface;
}

/// Lattice of the bone that is close to the tissue.
image::Grid lattice_around(const Box3& bone, Box3 tissue, std::span<const AdjacentBone> adjacent,
                           const RegularizationOptions& options) {
  const double spacing_mm = kSpacingFraction * options.node_spacing_mm;
  const Vec3 reach = Vec3::Constant(options.reach_mm);
  tissue.min() -= reach;
  tissue.max() += reach;
  const Box3 both = bone.intersection(tissue);
  double padding_mm = options.node_spacing_mm * (kWallFraction + kPadding_sigmas * kSigmaFraction) +
                      2.0 * spacing_mm;
  if (!adjacent.empty())
    padding_mm += std::ranges::max_element(adjacent, {}, &AdjacentBone::collar_mm)->collar_mm;
  image::Grid grid;
  grid.spacing_mm = Vec3::Constant(spacing_mm);
  grid.origin_L = both.min() - Vec3::Constant(padding_mm);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double length_mm = std::max(both.sizes()[Index(axis)], 0.0) + 2.0 * padding_mm;
    grid.size[axis] = Index(std::ceil(length_mm / spacing_mm)) + 1;
  }
  return grid;
}

/// Signed distances at the points of a lattice; infinite beyond the band and where unknown.
image::ScalarVolume distances_on(const image::Grid& grid, const field::DistanceField& field) {
  image::ScalarVolume distances{grid, std::vector<float>(std::size_t(grid.voxel_count()))};
  const Index row = grid.size[0];
  parallel_for(
      grid.size[1] * grid.size[2],
      [&](Index r) {
        std::vector<Vec3> points_L(static_cast<std::size_t>(row));
        const Index j = r % grid.size[1], k = r / grid.size[1];
        for (Index i = 0; i < row; ++i)
          points_L[std::size_t(i)] = grid.point_L(Vec3(double(i), double(j), double(k)));
        const std::span<float> of_row(distances.values.data() + r * row, std::size_t(row));
        field.distances(points_L, of_row);
        for (float& distance : of_row)
          if (std::isnan(distance)) distance = std::numeric_limits<float>::infinity();
      },
      8);
  return distances;
}

/// Distances from the tissue: those of the coarse field beyond the band of the fine one.
image::ScalarVolume distances_from(const image::Grid& grid, const TissueAtRest& tissue) {
  image::ScalarVolume distances = distances_on(grid, tissue.field_L);
  const image::ScalarVolume far = distances_on(grid, tissue.far_L);
  for (std::size_t v = 0; v < distances.values.size(); ++v)
    if (std::isinf(distances.values[v])) distances.values[v] = far.values[v];
  return distances;
}

/// Direction of the gradient at a point of the lattice; zero where a neighbor is infinite.
Vec3 direction_at(const image::ScalarVolume& distances, const std::array<Index, 3>& at) {
  const auto& size = distances.grid.size;
  Vec3 gradient;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::array<Index, 3> low = at, high = at;
    low[axis] = std::max<Index>(at[axis] - 1, 0);
    high[axis] = std::min(at[axis] + 1, size[axis] - 1);
    gradient[Index(axis)] = double(distances.at(high[0], high[1], high[2])) -
                            double(distances.at(low[0], low[1], low[2]));
  }
  const double length = gradient.norm();
  return std::isfinite(length) && length > 0.0 ? Vec3(gradient / length) : Vec3::Zero();
}

/// Whether a point lies in the cut between two bones, or beside it in one of them: on the way
/// through the cut it leaves one and enters the other.
bool is_in_cut(const image::ScalarVolume& bone, const image::ScalarVolume& other,
               const std::array<Index, 3>& at, double h_mm) {
  const double d_B = double(bone.at(at[0], at[1], at[2]));
  const double d_O = double(other.at(at[0], at[1], at[2]));
  return d_B + d_O < kCutFraction * h_mm &&
         direction_at(bone, at).dot(direction_at(other, at)) < -kMinAgreement;
}

/// Distances from the bone and from the collars of adjacent bones.
image::ScalarVolume distances_with_collars(const image::Grid& grid, const ContactBone& bone,
                                           std::span<const AdjacentBone> adjacent, double h_mm) {
  const image::ScalarVolume of_bone = distances_on(grid, *bone.field_B);
  image::ScalarVolume distances = of_bone;
  const Index row = grid.size[0], rows = grid.size[1] * grid.size[2];
  for (const AdjacentBone& other : adjacent) {
    if (other.collar_mm <= 0.0) continue;
    const image::ScalarVolume of_other = distances_on(grid, *other.field_L);
    parallel_for(
        rows,
        [&](Index r) {
          for (Index i = 0; i < row; ++i) {
            const auto v = std::size_t(r * row + i);
            const float beyond = of_bone.values[v] - float(other.collar_mm);
            float inside_other = std::max(of_other.values[v], beyond);
            if (beyond < 0.0F &&
                is_in_cut(of_bone, of_other, {i, r % grid.size[1], r / grid.size[1]}, h_mm))
              inside_other = beyond;
            distances.values[v] = std::min(distances.values[v], inside_other);
          }
        },
        8);
  }
  return distances;
}

/// Steps 1 and 2: positive inside, and at most one lattice spacing in magnitude.
image::ScalarVolume unsmoothed_level(const image::ScalarVolume& bone,
                                     const image::ScalarVolume& tissue,
                                     const RegularizationOptions& options) {
  const auto wall = float(kWallFraction * options.node_spacing_mm);
  const auto bound = float(kSpacingFraction * options.node_spacing_mm);
  const auto reach = float(options.reach_mm);
  image::ScalarVolume level = bone;
  const auto& size = bone.grid.size;
  parallel_for(
      size[1] * size[2],
      [&](Index r) {
        for (Index i = 0; i < size[0]; ++i) {
          const std::array<Index, 3> at{i, r % size[1], r / size[1]};
          const auto v = std::size_t(r * size[0] + i);
          const float d_B = bone.values[v], d_T = tissue.values[v];
          float inside = -d_B;
          if (d_B < wall && d_T > d_B &&
              direction_at(bone, at).dot(direction_at(tissue, at)) > kMinAgreement)
            inside = wall - d_B;
          inside = std::min({inside, d_T, reach - d_T});
          level.values[v] = std::clamp(inside, -bound, bound);
        }
      },
      8);
  return level;
}

/// Value that the fraction `p` of the values does not exceed; 0 if there are none.
double percentile(std::vector<double>& values, double p) {
  if (values.empty()) return 0.0;
  const auto at = values.begin() + std::ptrdiff_t(p * double(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Sets the distances of the regularized bone from the bone.
void measure(RegularizedBone& regularized, const field::DistanceField& bone_L,
             const field::DistanceField& tissue_L, double h_mm) {
  const std::vector<Vec3>& vertices_L = regularized.surface_L.vertices;
  std::vector<float> of_bone(vertices_L.size()), of_tissue(vertices_L.size());
  bone_L.distances(vertices_L, of_bone);
  tissue_L.distances(vertices_L, of_tissue);
  std::vector<double> distances_mm;
  for (std::size_t v = 0; v < vertices_L.size(); ++v)
    if (std::abs(of_tissue[v]) < 0.5 * h_mm && std::isfinite(of_bone[v]))
      distances_mm.push_back(std::abs(double(of_bone[v])));
  regularized.p50_distance_mm = percentile(distances_mm, 0.5);
  regularized.p99_distance_mm = percentile(distances_mm, 0.99);
}

/// Resolution of a field of the tissue: about the spacing.
int resolution_of(double side_mm, double spacing_mm) {
  constexpr unsigned kMin = 64, kMax = 256;
  const double cells = side_mm / spacing_mm;
  return int(std::clamp(std::bit_ceil(unsigned(std::min(cells, double(kMax)))), kMin, kMax));
}

}  // namespace

Result<TissueAtRest> tissue_at_rest(const mesh::VolumeMesh& tissue,
                                    const RegularizationOptions& options, Progress& progress) {
  LEFORT_CHECK(options.node_spacing_mm > 0.0 && options.reach_mm > options.node_spacing_mm);
  const geometry::TriangleMesh boundary_L = boundary_surface(tissue);
  const Box3 box_L = geometry::bounding_box(boundary_L);
  const double extent_mm = box_L.sizes().maxCoeff();
  const double spacing_mm = kSpacingFraction * options.node_spacing_mm;
  const auto field_of = [&](double wanted_mm, int coarsening) {
    const double min_mm = kMinBandFraction * extent_mm;  // At the highest resolution.
    const double band_mm = std::min(std::max(wanted_mm, min_mm), kMaxBandFraction * extent_mm);
    return field::build_distance_field(
        boundary_L,
        {.resolution = resolution_of(extent_mm + 2.0 * band_mm, coarsening * spacing_mm),
         .band_mm = band_mm},
        progress);
  };
  // A wall counts only where tissue lies behind it: its distance must be correct up to there.
  LEFORT_TRY(
      field::DistanceField field_L,
      field_of(kWallFraction * options.node_spacing_mm + kNearBand_spacings * spacing_mm, 1));
  // Trilinear distances reach a diagonal of a cell less than the band.
  const double diagonal_mm = std::numbers::sqrt3 * kFarCoarsening * spacing_mm;
  LEFORT_TRY(field::DistanceField far_L, field_of(options.reach_mm + diagonal_mm, kFarCoarsening));
  return TissueAtRest{box_L, std::move(field_L), std::move(far_L)};
}

double collar_mm(double node_spacing_mm, double separation_mm) {
  return kCollarFraction * std::max(node_spacing_mm - separation_mm, 0.0);
}

Result<RegularizedBone> regularize_bone(const ContactBone& bone,
                                        std::span<const AdjacentBone> adjacent,
                                        const TissueAtRest& tissue,
                                        const RegularizationOptions& options, Progress& progress) {
  const double h_mm = options.node_spacing_mm;
  LEFORT_CHECK(h_mm > 0.0 && options.reach_mm > h_mm);
  const image::Grid grid =
      lattice_around(geometry::bounding_box(bone.surface_B), tissue.box_L, adjacent, options);
  const double ball_ml = 4.0 / 3.0 * std::numbers::pi * std::pow(h_mm, 3) / 1000.0;
  RegularizedBone regularized;
  LEFORT_TRY(
      regularized.surface_L,
      anatomy::extract_isosurface(
          anatomy::smoothed(unsmoothed_level(distances_with_collars(grid, bone, adjacent, h_mm),
                                             distances_from(grid, tissue), options),
                            kSigmaFraction * h_mm),
          {.min_part_ml = ball_ml}, progress));
  measure(regularized, *bone.field_B, tissue.field_L, h_mm);
  return regularized;
}

}  // namespace lefort::predict
