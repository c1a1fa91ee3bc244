// Written files, read back by ITK, VTK and Python independently of lefort. Volume meshes are in
// test_vtu.cpp, point lists in test_markups_file.cpp, .seg.nrrd in test_slicer_files.cpp.
#include <lefort/geometry/rigid_motion.h>
#include <lefort/io/segmentation_file.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/transform_file.h>
#include <lefort/io/volume_files.h>

#include <gtest/gtest.h>
#include <vtkCell.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkOBJReader.h>
#include <vtkPLYReader.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSTLReader.h>
#include <vtkSmartPointer.h>
#include <vtkXMLPolyDataReader.h>

#include <sstream>
#include <string>

#include "io/itk_images.h"
#include "io/sample_scan.h"
#include "io/sample_surface.h"
#include "support/run_python.h"
#include "support/temporary_folder.h"

namespace lefort::io::test_independent_readers {
namespace {

using geometry::TriangleMesh;
using test::TemporaryFolder;
using test::tetrahedron;

template <class Reader>
vtkSmartPointer<vtkPolyData> read_by(const std::filesystem::path& path) {
  const vtkNew<Reader> reader;
  reader->SetFileName(path.c_str());
  reader->Update();
  return reader->GetOutput();
}

/// Expects equal triangles in equal order, with any numbering of vertices.
void expect_same(vtkPolyData& read, const TriangleMesh& written) {
  ASSERT_EQ(read.GetNumberOfPoints(), written.vertex_count());
  ASSERT_EQ(read.GetNumberOfCells(), written.triangle_count());
  for (Index t = 0; t < written.triangle_count(); ++t) {
    vtkCell* const cell = read.GetCell(t);
    ASSERT_STREQ(cell->GetClassName(), "vtkTriangle");
    for (int c = 0; c < 3; ++c)
      EXPECT_EQ(Vec3(read.GetPoint(cell->GetPointId(c))), written.corner(t, c)) << t << ", " << c;
  }
}

TEST(IndependentReaders, VtkReadsEverySurfaceFormat) {
  const TemporaryFolder folder;
  const TriangleMesh mesh = tetrahedron();
  for (const char* const name : {"a.vtp", "a.stl", "a.ply", "a.obj"})
    ASSERT_TRUE(write_surface(folder / name, mesh)) << name;
  expect_same(*read_by<vtkXMLPolyDataReader>(folder / "a.vtp"), mesh);
  expect_same(*read_by<vtkSTLReader>(folder / "a.stl"), mesh);
  expect_same(*read_by<vtkPLYReader>(folder / "a.ply"), mesh);
  expect_same(*read_by<vtkOBJReader>(folder / "a.obj"), mesh);
}

TEST(IndependentReaders, VtkReadsEveryBitOfAVtpAndItsArrays) {
  const TemporaryFolder folder;
  TriangleMesh mesh = tetrahedron();
  mesh.vertices[0] = {0.1, 1.0 / 3.0, 1e-300};
  ASSERT_TRUE(write_surface(folder / "a.vtp", mesh,
                            {{"gap_mm", std::vector<double>{0.1, 2, 3, -4}},
                             {"displacement_mm", std::vector<Vec3>(4, Vec3(0.5, -6.0, 0.1))}}));
  const auto read = read_by<vtkXMLPolyDataReader>(folder / "a.vtp");
  expect_same(*read, mesh);
  vtkDataArray* const gap = read->GetPointData()->GetArray("gap_mm");
  ASSERT_NE(gap, nullptr);
  EXPECT_EQ(gap->GetTuple1(0), 0.1);
  EXPECT_EQ(gap->GetTuple1(3), -4.0);
  vtkDataArray* const displacement = read->GetPointData()->GetArray("displacement_mm");
  ASSERT_NE(displacement, nullptr);
  ASSERT_EQ(displacement->GetNumberOfComponents(), 3);
  EXPECT_EQ(Vec3(displacement->GetTuple3(2)), Vec3(0.5, -6.0, 0.1));
}

void expect_grid(const test::ItkImage& read, const image::Grid& grid, double tolerance) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(Index(read.size[axis]), grid.size[axis]);
    EXPECT_NEAR(read.spacing[axis], grid.spacing_mm[Index(axis)], tolerance);
    EXPECT_NEAR(read.origin[axis], grid.origin_L[Index(axis)], 100.0 * tolerance);
    for (std::size_t column = 0; column < 3; ++column)
      EXPECT_NEAR(read.direction[axis][column], grid.direction(Index(axis), Index(column)),
                  tolerance);
  }
}

TEST(IndependentReaders, ItkReadsLabelsOfAnObliqueScan) {
  const TemporaryFolder folder;
  anatomy::LabelMap labels{test::sample_scan(test::oblique()).grid, {}};
  for (Index n = 0; n < labels.grid.voxel_count(); ++n)
    labels.values.push_back(static_cast<anatomy::Tissue>((n * n / 7) % 7));
  ASSERT_TRUE(write_segmentation(folder / "a.seg.nrrd", labels));
  const test::ItkImage read = test::read_itk_image((folder / "a.seg.nrrd").string());
  expect_grid(read, labels.grid, 1e-9);
  ASSERT_EQ(read.values.size(), labels.values.size());
  for (std::size_t v = 0; v < read.values.size(); ++v)
    EXPECT_EQ(read.values[v], double(labels.values[v])) << v;
}

TEST(IndependentReaders, ItkReadsVolumesInEveryFormat) {
  const image::CtVolume ct = test::sample_scan(test::oblique());
  for (const char* const name : {"a.nrrd", "a.nii.gz", "a.mha"}) {
    SCOPED_TRACE(name);
    const TemporaryFolder folder;
    ASSERT_TRUE(write_volume(folder / name, ct));
    const test::ItkImage read = test::read_itk_image((folder / name).string());
    expect_grid(read, ct.grid, 1e-5);  // NIfTI stores floats.
    ASSERT_EQ(read.values.size(), ct.values.size());
    for (std::size_t v = 0; v < read.values.size(); ++v)
      EXPECT_EQ(read.values[v], double(ct.values[v])) << v;
  }
}

/// Reads ITK's text format and prints the motion of a model in 3D Slicer: the inverse of the file's
/// transform, row by row, in LPS and in RAS.
constexpr const char* kReadTransform = R"py(
import sys
lines = open(sys.argv[1]).read().splitlines()
assert lines[0] == "#Insight Transform File V1.0" and lines[1].startswith("#Transform")
fields = dict(line.split(": ", 1) for line in lines if ": " in line)
assert fields["Transform"] == "AffineTransform_double_3_3", fields
p = [float(x) for x in fields["Parameters"].split()]
c = [float(x) for x in fields["FixedParameters"].split()]
assert len(p) == 12 and len(c) == 3
A = [p[0:3], p[3:6], p[6:9]]
t = [p[9 + r] + c[r] - sum(A[r][k] * c[k] for k in range(3)) for r in range(3)]
for r in range(3):
    for k in range(3):
        assert abs(sum(A[r][n] * A[k][n] for n in range(3)) - (r == k)) < 1e-12
R = [[A[k][r] for k in range(3)] for r in range(3)]
move = [R[r] + [-sum(R[r][k] * t[k] for k in range(3))] for r in range(3)]
flip = [-1, -1, 1, 1]
for sign in ([1, 1, 1, 1], flip):
    for r in range(3):
        print(" ".join(f"{sign[r] * sign[k] * move[r][k]:.9f}" for k in range(4)))
)py";

TEST(IndependentReaders, PythonReadsATransformInLpsAndRas) {
  const TemporaryFolder folder;
  const RigidTransform X_L = geometry::rigid_motion({1, -12, 5}, {0.1, 0.2, -0.3}, {100, 40, 30});
  ASSERT_TRUE(write_transform(folder / "move.tfm", X_L));
  const auto [ran, out] = test::run_python(kReadTransform, (folder / "move.tfm").string());
  ASSERT_TRUE(ran) << out;
  // A point p_R = F p_L in RAS moves to F X F p_R.
  const Mat3 F = Vec3(-1.0, -1.0, 1.0).asDiagonal();
  RigidTransform X_R = X_L;
  X_R.linear() = F * X_L.linear() * F;
  X_R.translation() = F * X_L.translation();
  std::istringstream numbers(out);
  for (const RigidTransform& wanted : {X_L, X_R})
    for (Index r = 0; r < 3; ++r)
      for (Index k = 0; k < 4; ++k) {
        double number = 0.0;
        ASSERT_TRUE(numbers >> number) << out;
        EXPECT_NEAR(number, wanted.matrix()(r, k), 1e-8) << r << ", " << k;
      }
}

}  // namespace
}  // namespace lefort::io::test_independent_readers
