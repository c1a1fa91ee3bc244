#include <lefort/anatomy/extract_surface.h>

#include <fmt/format.h>
#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace lefort::anatomy {
namespace {

// A value nearer to zero than this is moved away from it, on its own side: surfaces through a grid
// point have triangles without area. Far below what a scan resolves.
constexpr double kLeastLevel_mm = 2e-3;

Result<void> check_level(const image::ScalarVolume& level) {
  const auto& size = level.grid.size;
  if (std::min({size[0], size[1], size[2]}) < 3 ||
      std::max({size[0], size[1], size[2]}) > 100'000 ||
      level.grid.voxel_count() != Index(level.values.size()))
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format(
            "level has {} values, its grid of {} x {} x {} must be >= 3 each way and hold as many",
            level.values.size(), size[0], size[1], size[2]));
  for (Index k = 0; k < size[2]; ++k)
    for (Index j = 0; j < size[1]; ++j)
      for (Index i = 0; i < size[0]; ++i) {
        const float value = level.at(i, j, k);
        const bool outermost =
            i == 0 || j == 0 || k == 0 || i == size[0] - 1 || j == size[1] - 1 || k == size[2] - 1;
        if (!std::isfinite(value) || (outermost && value >= 0.0F))
          return fail(ErrorCode::kInvalidArgument,
                      fmt::format("level is {} at voxel ({}, {}, {}), must be finite{}", value, i,
                                  j, k, outermost ? " and negative on the grid's faces" : ""));
      }
  return {};
}

/// Zero surface in voxel indices V, oriented by falling level.
vtkNew<vtkPolyData> flying_edges(const image::ScalarVolume& level) {
  std::vector<float> values(level.values.size());
  std::transform(level.values.begin(), level.values.end(), values.begin(), [](float value) {
    const float size = std::max(std::abs(value), float(kLeastLevel_mm));
    return value >= 0.0F ? size : -size;
  });
  vtkNew<vtkFloatArray> scalars;
  scalars->SetArray(values.data(), vtkIdType(values.size()), 1);
  vtkNew<vtkImageData> image;
  image->SetDimensions(int(level.grid.size[0]), int(level.grid.size[1]), int(level.grid.size[2]));
  image->GetPointData()->SetScalars(scalars);
  vtkNew<vtkFlyingEdges3D> contour;
  contour->SetInputData(image);
  contour->SetValue(0, 0.0);
  contour->ComputeNormalsOff();
  contour->ComputeGradientsOff();
  contour->ComputeScalarsOff();
  contour->Update();
  vtkNew<vtkPolyData> surface;
  surface->ShallowCopy(contour->GetOutput());
  return surface;
}

double signed_volume(const geometry::TriangleMesh& mesh, Index triangle) {
  const Vec3 origin = mesh.vertices.front();
  return (mesh.corner(triangle, 0) - origin)
             .dot((mesh.corner(triangle, 1) - origin).cross(mesh.corner(triangle, 2) - origin)) /
         6.0;
}

/// For every vertex, the first vertex of its connected part.
std::vector<std::int32_t> part_of_vertices(const geometry::TriangleMesh& mesh) {
  std::vector<std::int32_t> parent(mesh.vertices.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](std::int32_t vertex) {
    while (parent[std::size_t(vertex)] != vertex) {
      parent[std::size_t(vertex)] = parent[std::size_t(parent[std::size_t(vertex)])];
      vertex = parent[std::size_t(vertex)];
    }
    return vertex;
  };
  for (const geometry::Triangle& triangle : mesh.triangles)
    for (const std::int32_t corner : {triangle[1], triangle[2]}) {
      const std::int32_t a = root(triangle[0]);
      const std::int32_t b = root(corner);
      parent[std::size_t(std::max(a, b))] = std::min(a, b);
    }
  for (std::int32_t vertex = 0; vertex < std::int32_t(parent.size()); ++vertex)
    parent[std::size_t(vertex)] = root(vertex);
  return parent;
}

/// The parts that enclose at least `smallest_mm3`, counted without sign.
geometry::TriangleMesh large_parts(const geometry::TriangleMesh& mesh, double smallest_mm3) {
  const std::vector<std::int32_t> part = part_of_vertices(mesh);
  std::vector<double> volume(mesh.vertices.size(), 0.0);
  for (Index t = 0; t < mesh.triangle_count(); ++t)
    volume[std::size_t(part[std::size_t(mesh.triangles[std::size_t(t)][0])])] +=
        signed_volume(mesh, t);

  geometry::TriangleMesh kept;
  std::vector<std::int32_t> renumbered(mesh.vertices.size(), -1);
  for (const geometry::Triangle& triangle : mesh.triangles) {
    if (std::abs(volume[std::size_t(part[std::size_t(triangle[0])])]) < smallest_mm3) continue;
    geometry::Triangle copy{};
    for (std::size_t corner = 0; corner < 3; ++corner) {
      std::int32_t& number = renumbered[std::size_t(triangle[corner])];
      if (number < 0) {
        number = std::int32_t(kept.vertices.size());
        kept.vertices.push_back(mesh.vertices[std::size_t(triangle[corner])]);
      }
      copy[corner] = number;
    }
    kept.triangles.push_back(copy);
  }
  return kept;
}

}  // namespace

Result<geometry::TriangleMesh> extract_isosurface(const image::ScalarVolume& level,
                                                  const IsosurfaceOptions& options,
                                                  Progress& progress) {
  if (!(options.smallest_part_ml >= 0.0))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("smallest_part_ml is {}, must be >= 0", options.smallest_part_ml));
  LEFORT_TRY_VOID(check_level(level));
  progress.begin_stage("extract the surface");
  if (progress.stop_requested()) return fail(ErrorCode::kCancelled, "extraction was cancelled");

  const vtkNew<vtkPolyData> surface = flying_edges(level);
  geometry::TriangleMesh mesh;
  mesh.vertices.reserve(std::size_t(surface->GetNumberOfPoints()));
  for (vtkIdType p = 0; p < surface->GetNumberOfPoints(); ++p)
    mesh.vertices.push_back(level.grid.point_L(Vec3(surface->GetPoint(p))));
  mesh.triangles.reserve(std::size_t(surface->GetNumberOfPolys()));
  vtkIdType count = 0;
  const vtkIdType* corners = nullptr;
  for (surface->GetPolys()->InitTraversal(); surface->GetPolys()->GetNextCell(count, corners) != 0;)
    mesh.triangles.push_back(
        {std::int32_t(corners[0]), std::int32_t(corners[1]), std::int32_t(corners[2])});

  if (mesh.triangles.empty())
    return fail(ErrorCode::kMeshInvalid, "level is negative everywhere, so it has no surface");
  progress.report(0.5);
  mesh = large_parts(mesh, options.smallest_part_ml * 1e3);
  if (mesh.triangles.empty())
    return fail(ErrorCode::kMeshInvalid,
                fmt::format("no part of the surface encloses {} ml", options.smallest_part_ml));
  progress.report(1.0);
  return mesh;
}

}  // namespace lefort::anatomy
