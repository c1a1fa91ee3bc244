#include <lefort/io/read_vtu.h>

#include <fmt/format.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDataArray.h>
#include <vtkErrorCode.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkObject.h>
#include <vtkPoints.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

namespace lefort::io {
namespace {

using mesh::ElementShape;

std::optional<ElementShape> shape_of(int vtk_cell) {
  switch (vtk_cell) {
    case VTK_TETRA:
      return ElementShape::kTet4;
    case VTK_PYRAMID:
      return ElementShape::kPyramid5;
    case VTK_WEDGE:
      return ElementShape::kWedge6;
    case VTK_HEXAHEDRON:
      return ElementShape::kHex8;
    case VTK_QUADRATIC_TETRA:
      return ElementShape::kTet10;
    case VTK_QUADRATIC_WEDGE:
      return ElementShape::kWedge15;
    case VTK_QUADRATIC_HEXAHEDRON:
      return ElementShape::kHex20;
    default:
      return std::nullopt;
  }
}

mesh::ElementBlock& block_of(mesh::VolumeMesh& mesh, ElementShape shape) {
  const auto found = std::find_if(mesh.blocks.begin(), mesh.blocks.end(),
                                  [&](const auto& block) { return block.shape == shape; });
  if (found != mesh.blocks.end()) return *found;
  mesh.blocks.push_back({.shape = shape, .nodes = {}, .region = {}});
  return mesh.blocks.back();
}

Result<mesh::VolumeMesh> convert(vtkUnstructuredGrid& grid, const std::string& name) {
  mesh::VolumeMesh mesh;
  mesh.nodes_L.resize(std::size_t(grid.GetNumberOfPoints()));
  for (std::size_t n = 0; n < mesh.nodes_L.size(); ++n) {
    grid.GetPoint(vtkIdType(n), mesh.nodes_L[n].data());
    if (!mesh.nodes_L[n].allFinite())
      return fail(ErrorCode::kFileCorrupt, fmt::format("mesh {}: node {} is not finite", name, n));
  }
  vtkDataArray* const regions = grid.GetCellData()->GetArray("region");
  vtkNew<vtkIdList> nodes;
  for (vtkIdType cell = 0; cell < grid.GetNumberOfCells(); ++cell) {
    const auto shape = shape_of(grid.GetCellType(cell));
    if (!shape)
      return fail(ErrorCode::kFileUnsupported,
                  fmt::format("mesh {}: element {} has VTK cell type {}, which is not solved with",
                              name, cell, grid.GetCellType(cell)));
    grid.GetCellPoints(cell, nodes);
    mesh::ElementBlock& block = block_of(mesh, *shape);
    for (vtkIdType corner = 0; corner < nodes->GetNumberOfIds(); ++corner) {
      const vtkIdType node = nodes->GetId(corner);
      if (node < 0 || node >= grid.GetNumberOfPoints())
        return fail(ErrorCode::kFileCorrupt,
                    fmt::format("mesh {}: element {} names missing node {}", name, cell, node));
      block.nodes.push_back(std::int32_t(node));
    }
    if (nodes->GetNumberOfIds() != mesh::node_count(*shape))
      return fail(ErrorCode::kFileCorrupt,
                  fmt::format("mesh {}: element {} has {} nodes, expected {}", name, cell,
                              nodes->GetNumberOfIds(), mesh::node_count(*shape)));
    block.region.push_back(regions != nullptr && cell < regions->GetNumberOfTuples()
                               ? std::int32_t(std::lround(regions->GetComponent(cell, 0)))
                               : 0);
  }
  return mesh;
}

}  // namespace

Result<mesh::VolumeMesh> read_vtu(const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(file))
    return fail(ErrorCode::kFileNotFound, fmt::format("{} is not a file", file.string()));
  vtkObject::GlobalWarningDisplayOff();  // VTK would tell a bad file in many lines on stderr.
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName(file.c_str());
  reader->Update();
  vtkUnstructuredGrid* const grid = reader->GetOutput();
  if (reader->GetErrorCode() != vtkErrorCode::NoError || grid == nullptr ||
      grid->GetNumberOfPoints() == 0 || grid->GetNumberOfCells() == 0)
    return fail(ErrorCode::kFileCorrupt,
                fmt::format("mesh {} is no whole VTK XML unstructured grid", file.string()));
  return convert(*grid, file.string());
}

}  // namespace lefort::io
