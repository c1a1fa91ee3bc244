#include <lefort/io/internal/wedge_order.h>
#include <lefort/io/read_text.h>
#include <lefort/io/read_vtu.h>
#include <lefort/io/vtu.h>
#include <lefort/io/write_atomically.h>
#include <lefort/mesh/box_grid.h>
#include <lefort/mesh/element_faces.h>
#include <lefort/mesh/element_quality.h>

#include <gtest/gtest.h>
#include <vtkCell.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLDataParser.h>
#include <vtkXMLUnstructuredGridReader.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <algorithm>
#include <limits>

#include "support/temporary_folder.h"

namespace lefort::io::test_vtu {
namespace {

using mesh::ElementBlock;
using mesh::ElementShape;
using mesh::VolumeMesh;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// An element of each shape with arbitrary nodes, since the writer ignores their positions.
VolumeMesh every_shape() {
  VolumeMesh mesh;
  for (int n = 0; n < 20; ++n) mesh.nodes_L.emplace_back(0.1 * n, -1.0 / (n + 1.0), 1e-7 * n * n);
  std::int32_t region = 3;
  for (const ElementShape shape :
       {ElementShape::kTet4, ElementShape::kPyramid5, ElementShape::kWedge6, ElementShape::kHex8,
        ElementShape::kTet10, ElementShape::kWedge15, ElementShape::kHex20}) {
    ElementBlock block{shape, {}, {region, -region}};
    for (std::int32_t n = 0; n < 2 * mesh::node_count(shape); ++n)
      block.nodes.push_back((7 * n + region) % 20);
    if (mesh::corner_count(shape) == 6) internal::renumber_wedges(block, mesh.nodes_L);
    mesh.blocks.push_back(block);
    ++region;
  }
  mesh.node_sets["fixed & \"posterior\""] = {0, 5, 19};
  return mesh;
}

VtuFields some_fields(const VolumeMesh& mesh) {
  std::vector<Vec3> displacement;
  for (const Vec3& p_L : mesh.nodes_L) displacement.emplace_back(p_L.y(), kNan, -p_L.x());
  std::vector<Mat3> stress(std::size_t(mesh.element_count()));
  std::vector<double> pressure(stress.size());
  for (std::size_t e = 0; e < stress.size(); ++e) {
    stress[e] << 1, 2, 3, 4, 5, 6, 7, 8, double(e);
    pressure[e] = 0.1 * double(e);
  }
  return {{vtu_array("displacement_mm", displacement)},
          {vtu_array("stress_mpa", stress), vtu_array("pressure_mpa", pressure)}};
}

vtkSmartPointer<vtkUnstructuredGrid> read_back(const std::filesystem::path& path) {
  const vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName(path.c_str());
  reader->Update();
  return reader->GetOutput();
}

TEST(Vtu, VtkReadsBackEveryShapeAndItsNodes) {
  const test::TemporaryFolder folder;
  const VolumeMesh mesh = every_shape();
  ASSERT_TRUE(write_vtu(folder / "m.vtu", mesh));
  const auto grid = read_back(folder / "m.vtu");
  ASSERT_EQ(grid->GetNumberOfPoints(), mesh.node_count());
  for (Index n = 0; n < mesh.node_count(); ++n)
    EXPECT_EQ(Vec3(grid->GetPoint(n)), mesh.nodes_L[std::size_t(n)]);
  ASSERT_EQ(grid->GetNumberOfCells(), mesh.element_count());
  vtkDataArray* const regions = grid->GetCellData()->GetArray("region");
  ASSERT_NE(regions, nullptr);
  vtkIdType c = 0;
  for (const ElementBlock& block : mesh.blocks) {
    for (Index e = 0; e < block.element_count(); ++e, ++c) {
      vtkCell* const cell = grid->GetCell(c);
      ASSERT_EQ(cell->GetNumberOfPoints(), mesh::node_count(block.shape));
      for (int n = 0; n < mesh::node_count(block.shape); ++n)
        EXPECT_EQ(cell->GetPointId(n), block.element(e)[n]);
      EXPECT_EQ(regions->GetTuple1(c), block.region[std::size_t(e)]);
    }
  }
  const char* const names[] = {"vtkTetra",
                               "vtkPyramid",
                               "vtkWedge",
                               "vtkHexahedron",
                               "vtkQuadraticTetra",
                               "vtkQuadraticWedge",
                               "vtkQuadraticHexahedron"};
  for (int b = 0; b < 7; ++b) EXPECT_STREQ(grid->GetCell(2 * b)->GetClassName(), names[b]);
}

TEST(Vtu, VtkReadsBackScalarsVectorsTensorsAndSets) {
  const test::TemporaryFolder folder;
  const VolumeMesh mesh = every_shape();
  ASSERT_TRUE(write_vtu(folder / "m.vtu", mesh, some_fields(mesh)));
  const auto grid = read_back(folder / "m.vtu");
  vtkDataArray* const displacement = grid->GetPointData()->GetArray("displacement_mm");
  ASSERT_NE(displacement, nullptr);
  ASSERT_EQ(displacement->GetNumberOfComponents(), 3);
  EXPECT_EQ(displacement->GetComponent(4, 2), -mesh.nodes_L[4].x());
  EXPECT_TRUE(std::isnan(displacement->GetComponent(4, 1)));
  vtkDataArray* const stress = grid->GetCellData()->GetArray("stress_mpa");
  ASSERT_EQ(stress->GetNumberOfComponents(), 9);
  for (int k = 0; k < 8; ++k) EXPECT_EQ(stress->GetComponent(6, k), k + 1);  // Row by row.
  EXPECT_EQ(stress->GetComponent(6, 8), 6.0);
  EXPECT_EQ(grid->GetCellData()->GetArray("pressure_mpa")->GetTuple1(13), 0.1 * 13.0);
  vtkDataArray* const fixed = grid->GetPointData()->GetArray("set:fixed & \"posterior\"");
  ASSERT_NE(fixed, nullptr);
  for (int n = 0; n < 20; ++n)
    EXPECT_EQ(fixed->GetTuple1(n), n == 0 || n == 5 || n == 19 ? 1.0 : 0.0);
}

TEST(Vtu, EqualMeshesGiveEqualBytes) {
  const test::TemporaryFolder folder;
  const VolumeMesh mesh = every_shape();
  ASSERT_TRUE(write_vtu(folder / "a.vtu", mesh, some_fields(mesh)));
  ASSERT_TRUE(write_vtu(folder / "b.vtu", mesh, some_fields(mesh)));
  EXPECT_EQ(read_text(folder / "a.vtu", 1'000'000).value(),
            read_text(folder / "b.vtu", 1'000'000).value());
}

TEST(Vtu, WritesAnEmptyMesh) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_vtu(folder / "empty.vtu", {}));
  const auto grid = read_back(folder / "empty.vtu");
  EXPECT_EQ(grid->GetNumberOfPoints(), 0);
  EXPECT_EQ(grid->GetNumberOfCells(), 0);
}

TEST(Vtu, RejectsInconsistentMeshesAndLeavesNothing) {
  const test::TemporaryFolder folder;
  const auto error_message = [&](const VolumeMesh& mesh) {
    return write_vtu(folder / "m.vtu", mesh).error().code;
  };
  for (const std::int32_t node : {20, -1}) {
    VolumeMesh mesh = every_shape();
    mesh.blocks[2].nodes[3] = node;
    EXPECT_EQ(error_message(mesh), ErrorCode::kMeshInvalid);
    mesh = every_shape();
    mesh.node_sets["moved"] = {node};
    EXPECT_EQ(error_message(mesh), ErrorCode::kMeshInvalid);
  }
  VolumeMesh mesh = every_shape();
  mesh.blocks[0].nodes.pop_back();
  EXPECT_EQ(error_message(mesh), ErrorCode::kMeshInvalid);
  EXPECT_EQ(folder.entry_count(), 0);
}

TEST(Vtu, RejectsInvalidFields) {
  const test::TemporaryFolder folder;
  const VolumeMesh mesh = every_shape();
  const std::vector<double> per_node(20, 1.0);
  const std::vector<double> one{1.0};
  const auto error_message = [&](const VtuFields& fields) {
    const auto written = write_vtu(folder / "m.vtu", mesh, fields);
    return written ? std::string("written") : written.error().message;
  };
  EXPECT_EQ(error_message({{vtu_array("a", one)}, {}}), "field a has 1 values, expected 20");
  EXPECT_EQ(error_message({{}, {vtu_array("a", per_node)}}), "field a has 20 values, expected 14");
  EXPECT_EQ(error_message({{{"a", 2, std::vector<double>(40)}}, {}}),
            "field a has 2 components, expected 1, 3 or 9");
  EXPECT_EQ(error_message({{vtu_array("a", per_node), vtu_array("a", per_node)}, {}}),
            "two fields are named a, names must differ");
  EXPECT_EQ(error_message({{}, {vtu_array("region", std::vector<double>(14))}}),
            "two fields are named region, names must differ");
  EXPECT_NE(error_message({{vtu_array("", per_node)}, {}}), "written");
  EXPECT_NE(error_message({{vtu_array("a\nb", per_node)}, {}}), "written");
}

TEST(Vtu, NamesAMissingFolder) {
  EXPECT_EQ(write_vtu("/nonexistent/m.vtu", {}).error().code, ErrorCode::kFileUnwritable);
  EXPECT_EQ(write_pvd("/nonexistent/m.pvd", {}).error().code, ErrorCode::kFileUnwritable);
}

TEST(ReadVtu, ReadsBackEveryShapeNodeAndRegion) {
  const test::TemporaryFolder folder;
  const VolumeMesh mesh = every_shape();
  ASSERT_TRUE(write_vtu(folder / "m.vtu", mesh, some_fields(mesh)));
  const auto read = read_vtu(folder / "m.vtu");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->nodes_L, mesh.nodes_L);
  ASSERT_EQ(read->blocks.size(), mesh.blocks.size());
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    EXPECT_EQ(read->blocks[b].shape, mesh.blocks[b].shape);
    EXPECT_EQ(read->blocks[b].nodes, mesh.blocks[b].nodes);
    EXPECT_EQ(read->blocks[b].region, mesh.blocks[b].region);
  }
}

/// VTK's own writer with compression, as in ParaView.
TEST(ReadVtu, ReadsRegionsFromTheRequestedArray) {
  const test::TemporaryFolder folder;
  const VolumeMesh mesh = mesh::make_box(ElementShape::kHex8, {3, 1, 1}, {3, 1, 1});
  const std::vector<double> material{4, 5, 4};
  const VtuFields fields{.elements = {vtu_array("material", std::span<const double>(material))}};
  ASSERT_TRUE(write_vtu(folder / "box.vtu", mesh, fields));
  EXPECT_EQ(read_vtu(folder / "box.vtu", "material")->blocks[0].region,
            (std::vector<std::int32_t>{4, 5, 4}));
  EXPECT_EQ(read_vtu(folder / "box.vtu")->blocks[0].region, (std::vector<std::int32_t>{0, 0, 0}));
  const auto lost = read_vtu(folder / "box.vtu", "color");
  ASSERT_FALSE(lost);
  EXPECT_NE(lost.error().message.find("box.vtu: there is no cell array color of regions"),
            std::string::npos)
      << lost.error().message;
}

TEST(ReadVtu, ReadsFilesOfVtk) {
  const test::TemporaryFolder folder;
  VolumeMesh mesh = every_shape();
  mesh.node_sets.clear();  // VTK does not escape names.
  ASSERT_TRUE(write_vtu(folder / "m.vtu", mesh));
  for (const int mode : {vtkXMLWriter::Ascii, vtkXMLWriter::Binary, vtkXMLWriter::Appended}) {
    const vtkNew<vtkXMLUnstructuredGridWriter> writer;
    writer->SetInputData(read_back(folder / "m.vtu"));
    writer->SetFileName((folder / "vtk.vtu").c_str());
    writer->SetDataMode(mode);
    ASSERT_EQ(writer->Write(), 1);
    const auto read = read_vtu(folder / "vtk.vtu");
    ASSERT_TRUE(read) << mode << ": " << read.error().message;
    EXPECT_EQ(read->nodes_L.size(), mesh.nodes_L.size());
    ASSERT_EQ(read->blocks.size(), mesh.blocks.size());
    for (std::size_t b = 0; b < mesh.blocks.size(); ++b)
      EXPECT_EQ(read->blocks[b].nodes, mesh.blocks[b].nodes);
  }
}

/// A mesh of one tetrahedron as text, with these arrays instead of its own.
std::string text_vtu(const std::string& points, const std::string& nodes, const std::string& ends,
                     const std::string& types, const std::string& regions = "7") {
  const auto array = [](const char* name, const std::string& numbers) {
    return "<DataArray Name=\"" + std::string(name) + "\" format=\"ascii\">" + numbers +
           "</DataArray>";
  };
  return "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece><Points>" +
         array("points", points) + "</Points><Cells>" + array("connectivity", nodes) +
         array("offsets", ends) + array("types", types) + "</Cells><CellData>" +
         array("region", regions) + "</CellData></Piece></UnstructuredGrid></VTKFile>";
}

/// As exported by meshio and Gmsh: points and curves of the geometry in addition to the elements.
TEST(ReadVtu, IgnoresPointsAndLines) {
  const test::TemporaryFolder folder;
  const VolumeMesh mesh = mesh::make_box(ElementShape::kHex8, {1, 1, 1}, {1, 1, 1});
  ASSERT_TRUE(write_vtu(folder / "m.vtu", mesh));
  const auto with_lines = [&](int extra_type, std::vector<vtkIdType> nodes) {
    const vtkNew<vtkUnstructuredGrid> grid;
    const auto box = read_back(folder / "m.vtu");
    grid->SetPoints(box->GetPoints());
    grid->InsertNextCell(extra_type, vtkIdType(nodes.size()), nodes.data());
    grid->InsertNextCell(VTK_HEXAHEDRON, box->GetCell(0)->GetPointIds());
    grid->InsertNextCell(extra_type, vtkIdType(nodes.size()), nodes.data());
    const vtkNew<vtkXMLUnstructuredGridWriter> writer;
    writer->SetInputData(grid);
    writer->SetFileName((folder / "lines.vtu").c_str());
    EXPECT_EQ(writer->Write(), 1);
    return read_vtu(folder / "lines.vtu");
  };
  for (const auto& read :
       {with_lines(VTK_VERTEX, {3}), with_lines(VTK_LINE, {0, 1}),
        with_lines(VTK_POLY_LINE, {0, 1, 2, 3}), with_lines(VTK_QUADRATIC_EDGE, {0, 1, 2})}) {
    ASSERT_TRUE(read) << read.error().message;
    ASSERT_EQ(read->blocks.size(), 1U);
    EXPECT_EQ(read->blocks[0].nodes, mesh.blocks[0].nodes);
  }
  const auto polygon = with_lines(VTK_POLYGON, {0, 1, 2, 3});
  ASSERT_FALSE(polygon);
  EXPECT_NE(polygon.error().message.find("type 7, which is not supported; expected"),
            std::string::npos)
      << polygon.error().message;
}

TEST(ReadVtu, RejectsInconsistentArrays) {
  const test::TemporaryFolder folder;
  const auto code = [&](const std::string& bytes) {
    EXPECT_TRUE(write_text(folder / "m.vtu", bytes));
    const auto mesh = read_vtu(folder / "m.vtu");
    return mesh ? ErrorCode::kNotConverged : mesh.error().code;
  };
  const std::string p = "0 0 0 1 0 0 0 1 0 0 0 1", n = "0 1 2 3";
  const auto corrupt = ErrorCode::kFileCorrupt;
  EXPECT_EQ(code(text_vtu(p, n, "4", "10")), ErrorCode::kNotConverged);
  EXPECT_EQ(code(text_vtu(p + " 7", n, "4", "10")), corrupt);
  EXPECT_EQ(code(text_vtu("0 0 0 1 0 0 0 1 0 0 0 nan", n, "4", "10")), corrupt);
  for (const char* const nodes : {"0 1 2 4", "0 1 2 -1", "0 1 2 0.5", "0 1 2 nan", "0 1 2", ""})
    EXPECT_EQ(code(text_vtu(p, nodes, "4", "10")), corrupt) << nodes;
  for (const char* const ends : {"3", "5", "-4", "nan", "4 8", ""})
    EXPECT_EQ(code(text_vtu(p, n, ends, "10")), corrupt) << ends;
  EXPECT_EQ(code(text_vtu(p, n, "4", "10 10")), corrupt);
  for (const char* const regions : {"7 7", "0.5", "nan", "3e9"})
    EXPECT_EQ(code(text_vtu(p, n, "4", "10", regions)), corrupt) << regions;
  EXPECT_EQ(code(text_vtu(p, "", "", "", "")), corrupt);
  EXPECT_EQ(code(text_vtu(p, n, "4", "42")), ErrorCode::kFileUnsupported);
  EXPECT_EQ(code("<VTKFile type=\"PolyData\"></VTKFile>"), corrupt);
  EXPECT_EQ(code("garbage"), corrupt);
  EXPECT_EQ(read_vtu(folder / "none.vtu").error().code, ErrorCode::kFileNotFound);
}

/// Boxes of linear and of quadratic elements with all their sets, and an empty one.
std::vector<VolumeMesh> meshes_with_sets() {
  std::vector<VolumeMesh> meshes{
      mesh::make_mixed_box(mesh::BoxMix::kAllLinear, {4, 1, 1}, {4, 1, 1}),
      mesh::make_mixed_box(mesh::BoxMix::kHex20Wedge15, {2, 1, 1}, {4, 1, 1}),
      mesh::make_mixed_box(mesh::BoxMix::kWedge15Tet10, {1, 1, 2}, {4, 1, 1})};
  for (VolumeMesh& mesh : meshes) {
    mesh.face_sets["none"] = {};
    mesh.node_sets["none"] = {};
  }
  return meshes;
}

TEST(ReadVtu, ReadsBackNodeSetsAndFaceSets) {
  const test::TemporaryFolder folder;
  for (const VolumeMesh& mesh : meshes_with_sets()) {
    ASSERT_TRUE(write_vtu(folder / "m.vtu", mesh, {}, VtuFaces::kWrite));
    const auto read = read_vtu(folder / "m.vtu");
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->node_sets, mesh.node_sets);
    EXPECT_EQ(read->face_sets, mesh.face_sets);
    ASSERT_TRUE(write_vtu(folder / "m.vtu", mesh));
    EXPECT_TRUE(read_vtu(folder / "m.vtu").value().face_sets.empty());
  }
}

TEST(Vtu, WritesFacesAsSeparateCellsWithoutValues) {
  const test::TemporaryFolder folder;
  const VolumeMesh mesh = meshes_with_sets()[0];
  const std::vector<double> values(std::size_t(mesh.element_count()), 1.5);
  ASSERT_TRUE(write_vtu(folder / "m.vtu", mesh, {{}, {vtu_array("p", values)}}, VtuFaces::kWrite));
  const auto grid = read_back(folder / "m.vtu");
  const auto faces = Index(mesh.face_sets.at("boundary").size());
  ASSERT_EQ(grid->GetNumberOfCells(), mesh.element_count() + faces);
  vtkDataArray* const x0 = grid->GetCellData()->GetArray("set:x0");
  ASSERT_NE(x0, nullptr);
  Index members = 0;
  for (vtkIdType c = 0; c < grid->GetNumberOfCells(); ++c) {
    const bool is_face = c >= mesh.element_count();
    EXPECT_EQ(grid->GetCell(c)->GetCellDimension(), is_face ? 2 : 3);
    EXPECT_EQ(std::isnan(grid->GetCellData()->GetArray("p")->GetTuple1(c)), is_face);
    members += Index(x0->GetTuple1(c));
  }
  EXPECT_EQ(members, Index(mesh.face_sets.at("x0").size()));
}

/// A tetrahedron and one of its faces as text, so that each number can be damaged.
std::string with_face(const std::string& face, const std::string& point_sets,
                      const std::string& cell_sets) {
  std::string text = text_vtu("0 0 0 1 0 0 0 1 0 0 0 1", "0 1 2 3 " + face, "4 7", "10 5", "7 9");
  const auto insert = [&](const std::string& before, const std::string& what) {
    text.insert(text.find(before), what);
  };
  insert("</CellData>", cell_sets);
  insert("<Points>", "<PointData>" + point_sets + "</PointData>");
  return text;
}

std::string set_array(const std::string& name, const std::string& values) {
  return "<DataArray Name=\"set:" + name + "\" format=\"ascii\">" + values + "</DataArray>";
}

TEST(ReadVtu, OrientsFacesOutwardAndNamesThoseWithoutASet) {
  const test::TemporaryFolder folder;
  const mesh::Face bottom{.shape = mesh::FaceShape::kTri3, .nodes = {0, 2, 1}};
  ASSERT_TRUE(write_text(folder / "m.vtu", with_face("0 1 2", set_array("a b", "0 1.0 0 1"),
                                                     set_array("skin", "0 1"))));
  auto read = read_vtu(folder / "m.vtu");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->face_sets, (decltype(read->face_sets){{"skin", {bottom}}}));
  EXPECT_EQ(read->node_sets, (decltype(read->node_sets){{"a b", {1, 3}}}));
  ASSERT_TRUE(write_text(folder / "m.vtu", with_face("2 0 1", "", "")));
  read = read_vtu(folder / "m.vtu");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->face_sets, (decltype(read->face_sets){{"region 9", {bottom}}}));
  EXPECT_EQ(read->blocks[0].region, (std::vector<std::int32_t>{7}));
}

TEST(ReadVtu, RejectsInvalidSets) {
  const test::TemporaryFolder folder;
  const auto error_message = [&](const std::string& text) {
    EXPECT_TRUE(write_text(folder / "m.vtu", text));
    const auto read = read_vtu(folder / "m.vtu");
    if (read) return std::string("read");
    return read.error().message.substr(read.error().message.find("m.vtu: ") + 7);
  };
  EXPECT_EQ(error_message(with_face("0 1 2", "", set_array("a", "1 1"))),
            "cell set \"a\" contains element 0, expected faces (two-dimensional cells) only");
  EXPECT_EQ(error_message(with_face("0 1 2", "", set_array("a", "0 2"))),
            "array \"set:a\" must have a name and one 0 or 1 for each of 2");
  EXPECT_EQ(error_message(with_face("0 1 2", set_array("a", "0 1 0"), "")),
            "array \"set:a\" must have a name and one 0 or 1 for each of 4");
  EXPECT_NE(error_message(with_face("0 1 2", set_array("", "0 0 0 0"), "")), "read");
  EXPECT_EQ(error_message(with_face("0 1 2", set_array("a&#10;b", "0 0 0 0"), "")),
            "a set has an unprintable name");
  EXPECT_EQ(error_message(with_face("0 1 1", "", "")),
            "face set \"region 9\": the face with corners 0, 1, 1 belongs to no element");
}

/// Gmsh, Abaqus and many others number the triangles of a wedge in reverse.
TEST(ReadVtu, ReadsBothNumberingsOfWedges) {
  const test::TemporaryFolder folder;
  for (const ElementShape shape : {ElementShape::kWedge6, ElementShape::kWedge15}) {
    const VolumeMesh mesh = mesh::make_box(shape, {1, 1, 1}, Vec3::Ones());
    VolumeMesh turned = mesh;
    const auto count = std::size_t(mesh::node_count(shape));
    for (std::size_t n = 0; n < turned.blocks[0].nodes.size(); ++n)
      turned.blocks[0].nodes[n] =
          mesh.blocks[0].nodes[n - n % count + internal::kOtherWedgeOrder[n % count]];
    EXPECT_EQ(mesh::poor_elements(turned, 0.0).size(), 2U);
    ASSERT_TRUE(write_vtu(folder / "m.vtu", turned));
    EXPECT_EQ(read_vtu(folder / "m.vtu").value().blocks[0].nodes, mesh.blocks[0].nodes);
  }
}

TEST(ReadVtu, RejectsTruncationsOrReadsTheWholeMesh) {
  const test::TemporaryFolder folder;
  const VolumeMesh mesh = every_shape();
  ASSERT_TRUE(write_vtu(folder / "m.vtu", mesh));
  const std::string whole = read_text(folder / "m.vtu", 1'000'000).value();
  int rejected = 0;
  for (std::size_t size = 0; size < whole.size(); size += 5) {
    ASSERT_TRUE(write_text(folder / "cut.vtu", whole.substr(0, size)));
    const auto read = read_vtu(folder / "cut.vtu");
    rejected += read ? 0 : 1;
    if (!read) continue;
    ASSERT_EQ(read->element_count(), mesh.element_count())
        << size;  // Truncated in the closing tags only.
  }
  EXPECT_GT(rejected, 100);
}

TEST(ReadVtu, DamagedBytesNeverCrash) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_vtu(folder / "m.vtu", every_shape()));
  const std::string whole = read_text(folder / "m.vtu", 1'000'000).value();
  int rejected = 0;
  for (std::size_t at = 0; at < whole.size(); at += 3)
    for (const char damage : {'9', '\xff', '\0'}) {
      std::string damaged = whole;
      damaged[at] = damage;
      ASSERT_TRUE(write_text(folder / "damaged.vtu", damaged));
      const auto read = read_vtu(folder / "damaged.vtu");
      rejected += read ? 0 : 1;
      if (!read) continue;
      for (const ElementBlock& block : read->blocks)
        for (const std::int32_t node : block.nodes) {
          ASSERT_GE(node, 0);
          ASSERT_LT(node, read->node_count());
        }
    }
  EXPECT_GT(rejected, 100);
}

TEST(Pvd, ListsTheFilesOfASeriesWithTheirTimes) {
  const test::TemporaryFolder folder;
  const std::vector<PvdEntry> entries{{0.0, "step_00.vtu"}, {1.0 / 3.0, "a & <b>.vtu"}};
  ASSERT_TRUE(write_pvd(folder / "series.pvd", entries));
  const vtkNew<vtkXMLDataParser> parser;
  parser->SetFileName((folder / "series.pvd").c_str());
  ASSERT_EQ(parser->Parse(), 1);
  vtkXMLDataElement* const root = parser->GetRootElement();
  EXPECT_STREQ(root->GetAttribute("type"), "Collection");
  vtkXMLDataElement* const collection = root->FindNestedElementWithName("Collection");
  ASSERT_EQ(collection->GetNumberOfNestedElements(), 2);
  for (int n = 0; n < 2; ++n) {
    vtkXMLDataElement* const data_set = collection->GetNestedElement(n);
    EXPECT_EQ(data_set->GetAttribute("file"), entries[std::size_t(n)].file);
    EXPECT_EQ(std::stod(data_set->GetAttribute("timestep")), entries[std::size_t(n)].time);
  }
}

TEST(Pvd, RejectsEntriesWithoutTimeOrName) {
  const test::TemporaryFolder folder;
  for (const PvdEntry& entry : {PvdEntry{kNan, "a.vtu"}, PvdEntry{0.0, ""}})
    EXPECT_EQ(write_pvd(folder / "s.pvd", {&entry, 1}).error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(folder.entry_count(), 0);
}

}  // namespace
}  // namespace lefort::io::test_vtu
