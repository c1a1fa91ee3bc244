#include <lefort/bench/skull_surface.h>

#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Count_stop_predicate.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_cost.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_placement.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>
#include <fmt/format.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageConstantPad.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkPolyDataConnectivityFilter.h>
#include <vtkShortArray.h>
#include <vtkWindowedSincPolyDataFilter.h>

#include <algorithm>
#include <vector>

namespace lefort::bench {

namespace {

constexpr double kAir_hu = -1024.0;

using Kernel = CGAL::Simple_cartesian<double>;
using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;

/// The isosurface in voxel indices, largest part, smoothed in mm.
vtkSmartPointer<vtkPolyData> smoothed_isosurface(const image::CtVolume& ct,
                                                 const SkullSurfaceOptions& options) {
  vtkNew<vtkImageData> voxels;
  const image::Grid& grid = ct.grid;
  voxels->SetDimensions(int(grid.size[0]), int(grid.size[1]), int(grid.size[2]));
  voxels->SetSpacing(grid.spacing_mm[0], grid.spacing_mm[1], grid.spacing_mm[2]);
  vtkNew<vtkShortArray> values;
  // VTK does not modify them.
  values->SetArray(const_cast<std::int16_t*>(ct.values.data()), vtkIdType(ct.values.size()), 1);
  voxels->GetPointData()->SetScalars(values);

  // A layer of air voxels closes the bone at the scan boundary.
  vtkNew<vtkImageConstantPad> padded;
  padded->SetInputData(voxels);
  padded->SetConstant(kAir_hu);
  padded->SetOutputWholeExtent(-1, int(grid.size[0]), -1, int(grid.size[1]), -1, int(grid.size[2]));

  vtkNew<vtkFlyingEdges3D> surface;
  surface->SetInputConnection(padded->GetOutputPort());
  surface->SetValue(0, options.bone_hu);
  surface->ComputeNormalsOff();
  surface->ComputeGradientsOff();
  surface->ComputeScalarsOff();
  vtkNew<vtkPolyDataConnectivityFilter> largest;
  largest->SetInputConnection(surface->GetOutputPort());
  largest->SetExtractionModeToLargestRegion();
  vtkNew<vtkWindowedSincPolyDataFilter> smooth;
  smooth->SetInputConnection(largest->GetOutputPort());
  smooth->SetNumberOfIterations(options.smoothing_iterations);
  smooth->SetPassBand(options.pass_band);
  smooth->NormalizeCoordinatesOn();
  smooth->FeatureEdgeSmoothingOff();
  smooth->BoundarySmoothingOff();
  smooth->Update();
  return smooth->GetOutput();
}

SurfaceMesh as_surface_mesh(vtkPolyData& polygons, const image::Grid& grid) {
  SurfaceMesh mesh;
  std::vector<SurfaceMesh::Vertex_index> vertex(std::size_t(polygons.GetNumberOfPoints()),
                                                SurfaceMesh::null_vertex());
  for (vtkIdType c = 0; c < polygons.GetNumberOfCells(); ++c) {
    vtkIdType count = 0;
    const vtkIdType* corners = nullptr;
    polygons.GetCellPoints(c, count, corners);
    std::array<SurfaceMesh::Vertex_index, 3> t;
    for (std::size_t k = 0; k < 3; ++k) {
      auto& v = vertex[std::size_t(corners[k])];
      if (v == SurfaceMesh::null_vertex()) {
        const Vec3 x = Vec3::Map(polygons.GetPoint(corners[k]));
        const Vec3 p_L = grid.point_L(x.cwiseQuotient(grid.spacing_mm));
        v = mesh.add_vertex({p_L.x(), p_L.y(), p_L.z()});
      }
      t[k] = v;
    }
    mesh.add_face(t[0], t[1], t[2]);
  }
  return mesh;
}

geometry::TriangleMesh as_triangle_mesh(const SurfaceMesh& mesh) {
  geometry::TriangleMesh triangles;
  std::vector<std::int32_t> number(mesh.num_vertices() + mesh.number_of_removed_vertices(), -1);
  for (const auto v : mesh.vertices()) {
    number[std::size_t(v)] = std::int32_t(triangles.vertices.size());
    const auto& p = mesh.point(v);
    triangles.vertices.emplace_back(p.x(), p.y(), p.z());
  }
  for (const auto f : mesh.faces()) {
    geometry::Triangle t{};
    std::size_t k = 0;
    for (const auto v : vertices_around_face(mesh.halfedge(f), mesh))
      t[k++] = number[std::size_t(v)];
    triangles.triangles.push_back(t);
  }
  return triangles;
}

}  // namespace

Result<geometry::TriangleMesh> extract_skull(const image::CtVolume& ct,
                                             const SkullSurfaceOptions& options,
                                             Progress& progress) {
  progress.begin_stage("extract the skull");
  const auto polygons = smoothed_isosurface(ct, options);
  SurfaceMesh mesh = as_surface_mesh(*polygons, ct.grid);
  if (Index(mesh.num_faces()) < options.triangles)
    return fail(ErrorCode::kMeshInvalid,
                fmt::format("the bone's surface has {} triangles; it must have at least {}",
                            mesh.num_faces(), options.triangles));
  if (progress.stop_requested())
    return fail(ErrorCode::kCancelled, "the skull extraction was cancelled");

  progress.begin_stage("simplify the skull");
  namespace Sms = CGAL::Surface_mesh_simplification;
  // Collapsing an edge of a closed surface removes two triangles and three edges.
  const auto edges = std::size_t(options.triangles * 3 / 2);
  Sms::edge_collapse(mesh, Sms::Count_stop_predicate<SurfaceMesh>(edges + 1),
                     CGAL::parameters::get_cost(Sms::LindstromTurk_cost<SurfaceMesh>())
                         .get_placement(Sms::LindstromTurk_placement<SurfaceMesh>()));
  geometry::TriangleMesh skull = as_triangle_mesh(mesh);
  if (skull.triangle_count() != options.triangles)
    return fail(ErrorCode::kMeshInvalid,
                fmt::format("the skull was simplified to {} triangles instead of {}",
                            skull.triangle_count(), options.triangles));
  return skull;
}

}  // namespace lefort::bench
