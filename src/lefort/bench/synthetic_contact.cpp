#include <lefort/bench/convergence.h>
#include <lefort/bench/unit_sphere.h>
#include <lefort/field/build/build_distance_field.h>
#include <lefort/mesh/box_grid.h>
#include <lefort/predict/tissue_boundary.h>

#include <array>
#include <memory>
#include <numbers>
#include <utility>

namespace lefort::bench {
namespace {

using geometry::TriangleMesh;

Vec3 block_size_mm() { return {24.0, 24.0, 10.0}; }
constexpr double kElement_mm = 1.5;

/// A cube of 12 mm whose lowest edge lies along y at the origin.
TriangleMesh cube_on_its_edge() {
  constexpr double kHalf_mm = 6.0;
  TriangleMesh cube;
  for (int corner = 0; corner < 8; ++corner)
    cube.vertices.emplace_back(corner & 1 ? kHalf_mm : -kHalf_mm, corner & 2 ? kHalf_mm : -kHalf_mm,
                               corner & 4 ? kHalf_mm : -kHalf_mm);
  constexpr std::array<std::array<std::int32_t, 4>, 6> kSides{
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  for (const auto& [a, b, c, d] : kSides) {
    cube.triangles.push_back({a, b, c});
    cube.triangles.push_back({a, c, d});
  }
  const Eigen::AngleAxisd rotation(0.25 * std::numbers::pi, Vec3::UnitY());
  for (Vec3& v : cube.vertices) v = rotation * v + Vec3(0.0, 0.0, kHalf_mm * std::numbers::sqrt2);
  return cube;
}

/// A coarse sphere of 6 mm with its lowest point at the origin: an octahedron whose edges are
/// halved three times. Its edges are about 1.2 mm, as long as those of the block.
TriangleMesh coarse_sphere() {
  constexpr double kRadius_mm = 6.0;
  constexpr int kHalvings = 3;
  TriangleMesh sphere{
      .vertices = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
      .triangles = {
          {0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
  for (int n = 0; n < kHalvings; ++n) halve_edges(sphere);
  for (Vec3& v : sphere.vertices) v = kRadius_mm * v + Vec3(0.0, 0.0, kRadius_mm);
  return sphere;
}

/// The bone touches the center of the upper side of a block, is pressed in and slides along it.
Result<ConvergenceCase> pressed_and_slid(std::string name, TriangleMesh bone, Progress& progress) {
  constexpr double kPressed_mm = 2.5, kSlid_mm = 5.0;
  ConvergenceCase task;
  task.name = task.mesh_name = std::move(name);
  const auto cells = [](double size_mm) { return int(std::lround(size_mm / kElement_mm)); };
  const Vec3 size_mm = block_size_mm();
  task.model.tissue =
      mesh::make_box(mesh::ElementShape::kTet4,
                     {cells(size_mm.x()), cells(size_mm.y()), cells(size_mm.z())}, size_mm);
  mesh::VolumeMesh& tissue = task.model.tissue;
  // Not aligned with the lattice, and no edge of the bone parallel to those of the mesh.
  const Eigen::AngleAxisd rotation(0.3, Vec3::UnitZ());
  const Vec3 at(0.4 * size_mm.x() + 0.13, 0.5 * size_mm.y() + 0.21, size_mm.z());
  for (Vec3& v : bone.vertices) v = rotation * v + at;
  tissue.node_sets[predict::sets::kMobilizedSegment] = tissue.node_sets.at("z1");
  tissue.node_sets[predict::sets::kFixed] = tissue.node_sets.at("z0");
  tissue.face_sets[predict::sets::kContact] = tissue.face_sets.at("z1");
  LEFORT_TRY(field::DistanceField field,
             field::build_distance_field(bone, {.resolution = 64, .band_mm = 3.0, .smooth = true},
                                         progress));
  task.model.segments.push_back(
      {std::move(bone), std::make_shared<const field::DistanceField>(std::move(field))});
  task.paths = {
      {.segment = task.name,
       .keyframes = {{.path_fraction = 0.4, .translation_mm = {0.0, 0.0, -kPressed_mm}},
                     {.path_fraction = 1.0, .translation_mm = {kSlid_mm, 0.4, -kPressed_mm}}},
       .steps = 20}};
  task.options.tissue.element_size_mm = kElement_mm;
  task.options.boundary.contact_snap_mm = 0.05;
  return task;
}

}  // namespace

Result<std::vector<ConvergenceCase>> synthetic_cases(Progress& progress) {
  std::vector<ConvergenceCase> cases;
  LEFORT_TRY(ConvergenceCase edge, pressed_and_slid("cube-edge", cube_on_its_edge(), progress));
  LEFORT_TRY(ConvergenceCase ball, pressed_and_slid("coarse-sphere", coarse_sphere(), progress));
  cases.push_back(std::move(edge));
  cases.push_back(std::move(ball));
  return cases;
}

}  // namespace lefort::bench
