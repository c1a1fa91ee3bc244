#include <lefort/io/internal/surface_formats.h>

#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkStringArray.h>
#include <vtkXMLPolyDataWriter.h>

namespace lefort::io::internal {

Result<std::string> vtp_bytes(const geometry::TriangleMesh& mesh,
                              const std::vector<VertexArray>& arrays) {
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(mesh.vertex_count());
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    points->SetPoint(v, mesh.vertices[std::size_t(v)].data());
  vtkNew<vtkCellArray> cells;
  for (const geometry::Triangle& triangle : mesh.triangles) {
    cells->InsertNextCell(3);
    for (const std::int32_t corner : triangle) cells->InsertCellPoint(corner);
  }
  vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  data->SetPolys(cells);
  vtkNew<vtkStringArray> space;
  space->SetName("SPACE");
  space->InsertNextValue("LPS");
  data->GetFieldData()->AddArray(space);

  for (const VertexArray& array : arrays) {
    vtkNew<vtkDoubleArray> values;
    values->SetName(array.name.c_str());
    if (const auto* scalars = std::get_if<std::vector<double>>(&array.values)) {
      for (const double value : *scalars) values->InsertNextValue(value);
    } else {
      values->SetNumberOfComponents(3);
      for (const Vec3& value : std::get<std::vector<Vec3>>(array.values))
        values->InsertNextTuple(value.data());
    }
    data->GetPointData()->AddArray(values);
  }

  vtkNew<vtkXMLPolyDataWriter> writer;
  writer->SetInputData(data);
  writer->SetDataModeToAppended();
  writer->EncodeAppendedDataOff();
  writer->SetCompressorTypeToZLib();
  writer->WriteToOutputStringOn();
  if (writer->Write() != 1)
    return fail(ErrorCode::kFileUnwritable, "the surface cannot be encoded as .vtp");
  return writer->GetOutputString();
}

}  // namespace lefort::io::internal
