#include <lefort/anatomy/extract_surface.h>
#include <lefort/geometry/mesh_properties.h>

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
#include <vector>

namespace lefort::anatomy {
namespace {

// Values closer to zero are set to this magnitude, with their sign: surfaces through grid points
// have triangles without area. Far below the resolution of a scan.
constexpr double kMinLevel_mm = 2e-3;

Result<void> check_level(const image::ScalarVolume& level) {
  const auto& size = level.grid.size;
  if (std::min({size[0], size[1], size[2]}) < 3 ||
      std::max({size[0], size[1], size[2]}) > 100'000 ||
      level.grid.voxel_count() != Index(level.values.size()))
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format(
            "level has {} values, which must match its grid of {} x {} x {}, at least 3 each way",
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

/// Zero surface in voxel indices V, oriented towards negative values.
vtkNew<vtkPolyData> flying_edges(const image::ScalarVolume& level) {
  std::vector<float> values(level.values.size());
  std::transform(level.values.begin(), level.values.end(), values.begin(), [](float value) {
    const float size = std::max(std::abs(value), float(kMinLevel_mm));
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

/// The connected components with an absolute enclosed volume of at least `min_mm3`.
geometry::TriangleMesh large_parts(const geometry::TriangleMesh& mesh, double min_mm3) {
  const geometry::Components parts = geometry::connected_components(mesh);
  const Vec3 origin = mesh.vertices.front();  // Near the mesh, against cancellation.
  std::vector<double> six_volumes_mm3(std::size_t(parts.count), 0.0);
  const auto component_of = [&](Index t) { return std::size_t(parts.of_triangle[std::size_t(t)]); };
  for (Index t = 0; t < mesh.triangle_count(); ++t)
    six_volumes_mm3[component_of(t)] +=
        (mesh.corner(t, 0) - origin)
            .dot((mesh.corner(t, 1) - origin).cross(mesh.corner(t, 2) - origin));
  return geometry::keep_triangles(
      mesh, [&](Index t) { return std::abs(six_volumes_mm3[component_of(t)]) >= 6.0 * min_mm3; });
}

}  // namespace

Result<geometry::TriangleMesh> extract_isosurface(const image::ScalarVolume& level,
                                                  const IsosurfaceOptions& options,
                                                  Progress& progress) {
  if (!(options.min_part_ml >= 0.0))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("min_part_ml is {}, must be >= 0", options.min_part_ml));
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
  mesh = large_parts(mesh, options.min_part_ml * 1e3);
  if (mesh.triangles.empty())
    return fail(ErrorCode::kMeshInvalid,
                fmt::format("no component of the surface encloses {} ml", options.min_part_ml));
  progress.report(1.0);
  return mesh;
}

}  // namespace lefort::anatomy
