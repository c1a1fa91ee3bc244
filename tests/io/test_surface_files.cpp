#include <lefort/io/read_text.h>
#include <lefort/io/surface_files.h>

#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <string>

#include "io/sample_surface.h"
#include "support/temporary_folder.h"

namespace lefort::io::test_surface_files {
namespace {

using geometry::TriangleMesh;
using test::TemporaryFolder;
using test::tetrahedron;

double volume(const TriangleMesh& mesh) {
  double six_volumes = 0.0;
  for (Index t = 0; t < mesh.triangle_count(); ++t)
    six_volumes += mesh.corner(t, 0).dot(mesh.corner(t, 1).cross(mesh.corner(t, 2)));
  return six_volumes / 6.0;
}

void expect_same(const TriangleMesh& read, const TriangleMesh& written) {
  ASSERT_EQ(read.vertex_count(), written.vertex_count());
  ASSERT_EQ(read.triangle_count(), written.triangle_count());
  // Vertex numbers may differ, corners must not.
  for (Index t = 0; t < read.triangle_count(); ++t)
    for (int c = 0; c < 3; ++c)
      EXPECT_EQ(read.corner(t, c), written.corner(t, c)) << t << ", " << c;
}

Result<TriangleMesh> read_bytes(const std::string& name, const std::string& bytes) {
  static const TemporaryFolder folder;  // Thousands of files: one folder for all.
  std::ofstream(folder / name, std::ios::binary) << bytes;
  return read_surface(folder / name);
}

ErrorCode code_of(const std::string& name, const std::string& bytes) {
  const auto mesh = read_bytes(name, bytes);
  EXPECT_FALSE(mesh) << name << " was read";
  return mesh ? ErrorCode::kCancelled : mesh.error().code;
}

constexpr const char* kFormats[] = {"a.vtp", "a.stl", "a.ply", "a.obj", "A.STL"};

TEST(SurfaceFiles, EveryFormatPreservesTheSurface) {
  for (const char* name : kFormats) {
    SCOPED_TRACE(name);
    const TemporaryFolder folder;
    ASSERT_TRUE(write_surface(folder / name, tetrahedron()));
    const auto read = read_surface(folder / name);
    ASSERT_TRUE(read) << read.error().message;
    expect_same(*read, tetrahedron());
    EXPECT_EQ(folder.entry_count(), 1);
  }
}

TEST(SurfaceFiles, VtpPreservesEveryBitOfACoordinate) {
  TriangleMesh mesh = tetrahedron();
  mesh.vertices[0] = {0.1, 1.0 / 3.0, 1e-300};
  const TemporaryFolder folder;
  ASSERT_TRUE(write_surface(folder / "a.vtp", mesh));
  expect_same(read_surface(folder / "a.vtp").value(), mesh);
}

TEST(SurfaceFiles, EqualSurfacesGiveEqualBytes) {
  for (const char* name : kFormats) {
    const TemporaryFolder folder;
    ASSERT_TRUE(write_surface(folder / name, tetrahedron()));
    const std::string first = read_text(folder / name, 1 << 20).value();
    ASSERT_TRUE(write_surface(folder / name, tetrahedron()));
    EXPECT_EQ(first, read_text(folder / name, 1 << 20).value()) << name;
  }
}

TEST(SurfaceFiles, EveryFormatStatesLps) {
  for (const char* name : {"a.stl", "a.ply", "a.obj"}) {
    const TemporaryFolder folder;
    ASSERT_TRUE(write_surface(folder / name, tetrahedron()));
    EXPECT_NE(read_text(folder / name, 1 << 20).value().find("SPACE=LPS"), std::string::npos);
  }
}

TEST(SurfaceFiles, ConvertsRasToLpsWithoutMirroring) {
  const std::string ras =
      "# SPACE=RAS\nv -1 -0.5 0.25\nv -4 -1 0\nv 0 -7 2\nv -1.5 -2 9\n"
      "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
  const auto mesh = read_bytes("a.obj", ras);
  ASSERT_TRUE(mesh);
  expect_same(*mesh, tetrahedron());
  EXPECT_GT(volume(*mesh), 0.0);
}

TEST(SurfaceFiles, WritesArraysByName) {
  const TemporaryFolder folder;
  const std::vector<VertexArray> arrays{
      {"gap_mm", std::vector<double>{1, 2, 3, 4}},
      {"displacement_mm", std::vector<Vec3>(4, Vec3(0.0, -6.0, 0.0))}};
  ASSERT_TRUE(write_surface(folder / "a.vtp", tetrahedron(), arrays));
  const std::string bytes = read_text(folder / "a.vtp", 1 << 20).value();
  EXPECT_NE(bytes.find("Name=\"gap_mm\""), std::string::npos);
  EXPECT_NE(bytes.find("Name=\"displacement_mm\" NumberOfComponents=\"3\""), std::string::npos);
  EXPECT_TRUE(read_surface(folder / "a.vtp"));
}

TEST(SurfaceFiles, RejectsArraysOfWrongLength) {
  const TemporaryFolder folder;
  const auto short_array =
      write_surface(folder / "a.vtp", tetrahedron(), {{"gap_mm", std::vector<double>{1, 2}}});
  ASSERT_FALSE(short_array);
  EXPECT_EQ(short_array.error().message, "array gap_mm has 2 values, the surface 4 vertices");
  const auto in_stl =
      write_surface(folder / "a.stl", tetrahedron(), {{"gap_mm", std::vector<double>(4)}});
  ASSERT_FALSE(in_stl);
  EXPECT_EQ(in_stl.error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(folder.entry_count(), 0);
}

TEST(SurfaceFiles, RejectsUnknownEndingsAndMissingFilesAndFolders) {
  const TemporaryFolder folder;
  EXPECT_EQ(read_surface(folder / "a.step").error().code, ErrorCode::kFileUnsupported);
  EXPECT_EQ(read_surface(folder / "a.stl").error().code, ErrorCode::kFileNotFound);
  EXPECT_EQ(write_surface(folder / "a.step", tetrahedron()).error().code,
            ErrorCode::kFileUnsupported);
  EXPECT_EQ(write_surface(folder / "no" / "a.vtp", tetrahedron()).error().code,
            ErrorCode::kFileUnwritable);
}

TEST(SurfaceFiles, ReadsTextStlWithExponents) {
  const auto mesh = read_bytes(
      "a.stl",
      "solid a name\r\nfacet normal 0 0 1\r\nouter loop\r\nvertex 0 0 0\r\nvertex +1e0 0 0\r\n"
      "vertex 0 1.5E+00 -0\r\nendloop\r\nendfacet\r\nendsolid\r\n");
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->corner(0, 2), Vec3(0.0, 1.5, 0.0));
}

TEST(SurfaceFiles, ReadsTextVtpWithTwoPiecesAndAStrip) {
  const auto array = [](const std::string& attributes, const std::string& numbers) {
    return "<DataArray format=\"ascii\" " + attributes + ">" + numbers + "</DataArray>";
  };
  const std::string points =
      "<Points>" + array("type=\"Float32\"", "0 0 0 1 0 0 0 1 0 1 1 0") + "</Points>";
  const std::string strip = "<Strips>" + array("type=\"Int32\" Name=\"connectivity\"", "0 1 2 3") +
                            array("type=\"Int32\" Name=\"offsets\"", "4") + "</Strips>";
  const std::string face = "<Polys>" + array("type=\"Int32\" Name=\"connectivity\"", "3 2 1") +
                           array("type=\"Int32\" Name=\"offsets\"", "3") + "</Polys>";
  const auto mesh =
      read_bytes("a.vtp", "<VTKFile type=\"PolyData\"><PolyData><Piece>" + points + strip +
                              "</Piece><Piece>" + points + face + "</Piece></PolyData></VTKFile>");
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->triangle_count(), 3);
  EXPECT_EQ(mesh->vertex_count(), 7);
  for (Index t = 0; t < 2; ++t)
    EXPECT_GT(
        (mesh->corner(t, 1) - mesh->corner(t, 0)).cross(mesh->corner(t, 2) - mesh->corner(t, 0))[2],
        0.0);
}

TEST(SurfaceFiles, RejectsVtpWithADocumentTypeOrDeepElements) {
  const TemporaryFolder folder;
  const std::string rest =
      "<VTKFile type=\"PolyData\"><PolyData><Piece>&e0;</Piece></PolyData></VTKFile>";
  std::string entities = "<!ENTITY e100000 \"1\">";
  for (int n = 0; n < 100'000; ++n)  // expat calls itself for each.
    entities += "<!ENTITY e" + std::to_string(n) + " \"&e" + std::to_string(n + 1) + ";\">";
  std::string deep = "<VTKFile type=\"PolyData\">";
  for (int n = 0; n < 100'000; ++n) deep += "<a>";
  for (const std::string& bytes :
       {"<?xml version=\"1.0\"?><!DOCTYPE VTKFile [" + entities + "]>" + rest,
        "<!DOCTYPE VTKFile>" + rest, deep}) {
    test::write_bytes(folder / "a.vtp", bytes);
    const auto surface = read_surface(folder / "a.vtp");
    ASSERT_FALSE(surface);
    EXPECT_EQ(surface.error().code, ErrorCode::kFileCorrupt);
    EXPECT_NE(surface.error().message.find("not a VTK XML file"), std::string::npos)
        << surface.error().message;
  }
}

TEST(SurfaceFiles, ReadsPlyAsTextAndInBothByteOrders) {
  const std::string header =
      " 1.0\nelement camera 1\nproperty list uchar float poses\nelement vertex 3\n"
      "property double x\nproperty uchar red\nproperty float y\nproperty short z\n"
      "element face 1\nproperty list uchar int vertex_index\nend_header\n";
  const auto text = read_bytes(
      "a.ply", "ply\nformat ascii" + header + "2 0.5 0.5\n0 9 0 0\n1 9 0 0\n0.5 9 2 -3\n3 0 1 2\n");
  ASSERT_TRUE(text) << text.error().message;
  EXPECT_EQ(text->corner(0, 2), Vec3(0.5, 2.0, -3.0));

  const auto big_endian = [](auto value) {
    std::string bytes(reinterpret_cast<const char*>(&value), sizeof value);
    return std::string(bytes.rbegin(), bytes.rend());
  };
  std::string body("\0", 1);
  for (const Vec3& p : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0.5, 2, -3)})
    body += big_endian(p[0]) + "r" + big_endian(float(p[1])) + big_endian(std::int16_t(p[2]));
  body += "\3";
  for (const std::int32_t corner : {0, 1, 2}) body += big_endian(corner);
  const auto binary = read_bytes("a.ply", "ply\nformat binary_big_endian" + header + body);
  ASSERT_TRUE(binary) << binary.error().message;
  expect_same(*binary, *text);
}

TEST(SurfaceFiles, TriangulatesPolygons) {
  // An arrowhead: a fan from its first corner would extend beyond it.
  const auto mesh = read_bytes("a.obj", "v 0 2 0\nv -2 -2 0\nv 0 -1 0\nv 2 -2 0\nf 2/1 3//2 4 1\n");
  ASSERT_TRUE(mesh);
  ASSERT_EQ(mesh->triangle_count(), 2);
  double area = 0.0;
  for (Index t = 0; t < 2; ++t) {
    const Vec3 cross =
        (mesh->corner(t, 1) - mesh->corner(t, 0)).cross(mesh->corner(t, 2) - mesh->corner(t, 0));
    EXPECT_GT(cross[2], 0.0);
    area += 0.5 * cross.norm();
  }
  EXPECT_NEAR(area, 6.0, 1e-6);
}

TEST(SurfaceFiles, NegativeObjNumbersCountFromTheEnd) {
  const auto mesh = read_bytes("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 \\\n -1\nv 5 5 5\n");
  ASSERT_TRUE(mesh);
  EXPECT_EQ(mesh->corner(0, 2), Vec3(0.0, 1.0, 0.0));
  EXPECT_EQ(mesh->vertex_count(), 3) << "a vertex no triangle uses is dropped";
}

TEST(SurfaceFiles, RemovesTrianglesWithARepeatedCorner) {
  const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  EXPECT_EQ(read_bytes("a.obj", points + "f 1 2 3\nf 1 1 2\n").value().triangle_count(), 1);
  EXPECT_EQ(code_of("a.obj", points + "f 1 1 2\n"), ErrorCode::kMeshInvalid);
}

TEST(SurfaceFiles, RejectsFilesWithoutTriangles) {
  EXPECT_EQ(code_of("a.stl", "solid empty\nendsolid empty\n"), ErrorCode::kMeshInvalid);
  EXPECT_EQ(code_of("a.stl", std::string(84, '\0')), ErrorCode::kMeshInvalid);
  EXPECT_EQ(code_of("a.obj", "v 0 0 0\n"), ErrorCode::kMeshInvalid);
}

TEST(SurfaceFiles, RejectsEmptyAndForeignFiles) {
  std::string noise;
  for (unsigned n = 0; n < 4000; ++n) noise += char(n * 2654435761U >> 24);
  for (const char* name : {"a.vtp", "a.stl", "a.ply", "a.obj"})
    for (const std::string& bytes :
         {std::string(), std::string("\0", 1), std::string("hello\n"), noise,
          std::string("<VTKFile"), std::string("<?xml version=\"1.0\"?><html></html>")})
      EXPECT_EQ(code_of(name, bytes), ErrorCode::kFileCorrupt)
          << name << ": " << bytes.substr(0, 9);
}

TEST(SurfaceFiles, RejectsNonFiniteCoordinates) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const char* name : {"a.vtp", "a.stl", "a.ply", "a.obj"})
    for (const double bad : {double(nan), std::numeric_limits<double>::infinity()})
      for (const std::size_t vertex : {0U, 1U, 2U, 3U})
        for (const Index axis : {0, 1, 2}) {
          TriangleMesh mesh = tetrahedron();
          mesh.vertices[vertex][axis] = bad;
          const TemporaryFolder folder;
          ASSERT_TRUE(write_surface(folder / name, mesh));
          const auto read = read_surface(folder / name);
          ASSERT_FALSE(read) << name << ", vertex " << vertex << ", axis " << axis;
          EXPECT_EQ(read.error().code, ErrorCode::kFileCorrupt);
        }
}

TEST(SurfaceFiles, RejectsATextStlWithAnInvalidNumber) {
  EXPECT_EQ(code_of("a.stl",
                    "solid a\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nvertex nan 0 0\n"
                    "vertex 1 0 0\nvertex 0 0 1\nendsolid\n"),
            ErrorCode::kFileCorrupt);
}

TEST(SurfaceFiles, RejectsCornersOutOfRange) {
  const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (const char* face :
       {"f 1 2 4\n", "f 1 2 0\n", "f 1 2 -4\n", "f 1 2 x\n", "f 1 2 3 99999999999\n"})
    EXPECT_EQ(code_of("a.obj", points + face), ErrorCode::kFileCorrupt) << face;
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
      "z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 "
      "0\n";
  for (const char* face : {"3 0 1 3\n", "3 0 1 -1\n", "3 0 1 0.5\n", "4 0 1 2\n"})
    EXPECT_EQ(code_of("a.ply", ply + face), ErrorCode::kFileCorrupt) << face;
}

TEST(SurfaceFiles, DoesNotTrustCountsInHeaders) {
  std::string stl(84, '\0');
  stl.replace(80, 4, "\xff\xff\xff\xff");
  EXPECT_EQ(code_of("a.stl", stl), ErrorCode::kFileCorrupt);
  for (const char* count : {"2000000000", "1999999999", "-1", "1e99", "x"})
    EXPECT_EQ(
        code_of("a.ply", std::string("ply\nformat binary_little_endian 1.0\nelement vertex ") +
                             count + "\nproperty float x\nend_header\n1234"),
        ErrorCode::kFileCorrupt);
  EXPECT_EQ(code_of("a.vtp",
                    "<?xml version=\"1.0\"?><VTKFile type=\"PolyData\" version=\"1.0\" "
                    "byte_order=\"LittleEndian\"><PolyData><Piece NumberOfPoints=\"99999999999\" "
                    "NumberOfPolys=\"1\"></Piece></PolyData></VTKFile>"),
            ErrorCode::kFileCorrupt);
}

/// A surface whose points are `count` zeros in one zlib block, `copies` times.
std::string vtp_of_zeros(std::size_t count, int copies, bool fractions) {
  const std::string zeros(count, '\0');
  std::string packed(count / 500 + 1000, '\0');
  uLongf length = packed.size();
  EXPECT_EQ(compress2(reinterpret_cast<Bytef*>(packed.data()), &length,
                      reinterpret_cast<const Bytef*>(zeros.data()), zeros.size(), 9),
            Z_OK);
  packed.resize(length);
  std::string data;
  std::string pieces;
  for (int n = 0; n < copies; ++n) {
    pieces += "<Piece><Points><DataArray type=\"Int8\" format=\"appended\" offset=\"" +
              std::to_string(fractions ? 0 : data.size()) + "\"/></Points></Piece>";
    for (const std::size_t size : {std::size_t(1), count, std::size_t(0), packed.size()})
      data.append(reinterpret_cast<const char*>(&size), 4);
    data += packed;
  }
  return "<VTKFile type=\"PolyData\" compressor=\"vtkZLibDataCompressor\"><PolyData>" + pieces +
         "</PolyData><AppendedData encoding=\"raw\">_" + data + "</AppendedData></VTKFile>";
}

TEST(SurfaceFiles, RejectsAVtpThatDecompressesToFarMoreThanItsLength) {
  // Points without polygons are not a surface, but the file is not damaged.
  const std::size_t million = 999'999;
  EXPECT_EQ(code_of("a.vtp", vtp_of_zeros(million, 2, false)), ErrorCode::kMeshInvalid);
  EXPECT_EQ(code_of("a.vtp", vtp_of_zeros(million, 2, true)), ErrorCode::kFileCorrupt);
  // 9 MB each in memory: each is within the limit, their sum is not.
  EXPECT_EQ(code_of("a.vtp", vtp_of_zeros(million, 10, false)), ErrorCode::kFileCorrupt);
}

TEST(SurfaceFiles, IgnoresOtherArraysOfAVtp) {
  const auto mesh = read_bytes(
      "a.vtp",
      "<VTKFile type=\"PolyData\"><PolyData><FieldData>"
      "<Array Name=\"TITLE\" format=\"ascii\" type=\"Int8\">no numbers</Array></FieldData><Piece>"
      "<Points><DataArray format=\"ascii\">0 0 0 1 0 0 0 1 0</DataArray>"
      "<DataArray format=\"ascii\">a second one</DataArray></Points><Polys>"
      "<DataArray format=\"ascii\" Name=\"connectivity\">0 1 2</DataArray>"
      "<DataArray format=\"ascii\" Name=\"offsets\">3</DataArray>"
      "<DataArray format=\"ascii\" Name=\"faces\">no numbers</DataArray></Polys>"
      "</Piece></PolyData></VTKFile>");
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->triangle_count(), 1);
}

/// Any truncation must be detected, or give complete triangles of the surface.
TEST(SurfaceFiles, RejectsTruncationsOrReadsLess) {
  for (const char* name : {"a.vtp", "a.stl", "a.ply", "a.obj"}) {
    const TemporaryFolder folder;
    ASSERT_TRUE(write_surface(folder / name, tetrahedron()));
    const std::string bytes = read_text(folder / name, 1 << 20).value();
    for (std::size_t size = 0; size + 2 < bytes.size(); size += 7) {
      const auto mesh = read_bytes(name, bytes.substr(0, size));
      // A VTP may lose its closing tags without losing data, and an OBJ whole lines.
      if (mesh && name != std::string("a.obj") && name != std::string("a.vtp"))
        ADD_FAILURE() << name << " of " << size << " bytes was read";
      if (mesh) {
        EXPECT_LE(mesh->triangle_count(), 4);
      }
    }
  }
}

TEST(SurfaceFiles, DamagedBytesNeverCrash) {
  for (const char* name : {"a.vtp", "a.stl", "a.ply", "a.obj"}) {
    const TemporaryFolder folder;
    ASSERT_TRUE(write_surface(folder / name, tetrahedron()));
    const std::string bytes = read_text(folder / name, 1 << 20).value();
    for (std::size_t at = 0; at < bytes.size(); at += 3)
      for (const char damage : {'9', '\xff'}) {
        std::string damaged = bytes;
        damaged[at] = damage;
        const auto mesh = read_bytes(name, damaged);
        if (mesh) {
          EXPECT_GT(mesh->triangle_count(), 0);
        }
      }
  }
}

}  // namespace
}  // namespace lefort::io::test_surface_files
