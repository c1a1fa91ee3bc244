#include <lefort/io/gmsh.h>
#include <lefort/io/volume_mesh_files.h>
#include <lefort/io/vtu.h>
#include <lefort/io/write_atomically.h>
#include <lefort/mesh/boundary_faces.h>
#include <lefort/mesh/box_grid.h>
#include <lefort/mesh/element_quality.h>

#include <gtest/gtest.h>

#include <functional>

#include "io/gmsh_writer.h"
#include "support/temporary_folder.h"

namespace lefort::io::test_gmsh {
namespace {

using mesh::ElementShape;
using mesh::VolumeMesh;
using test::GmshForm;

const Vec3 kSize_mm(4, 3, 2);

std::vector<VolumeMesh> some_meshes() {
  std::vector<VolumeMesh> meshes;
  for (const ElementShape shape :
       {ElementShape::kTet4, ElementShape::kPyramid5, ElementShape::kWedge6, ElementShape::kHex8,
        ElementShape::kTet10, ElementShape::kWedge15, ElementShape::kHex20})
    meshes.push_back(mesh::make_box(shape, {2, 1, 2}, kSize_mm));
  meshes.push_back(mesh::make_mixed_box(mesh::BoxMix::kAllLinear, {4, 2, 1}, kSize_mm));
  for (VolumeMesh& mesh : meshes) {
    mesh.blocks[0].region[0] = 7;
    mesh.region_names = {{0, "fat"}, {7, "muscle of the lip"}};
    mesh.node_sets["tip"] = {0, 2};
  }
  return meshes;
}

Result<VolumeMesh> read_gmsh_bytes(const std::string& bytes) {
  const test::TemporaryFolder folder;
  EXPECT_TRUE(write_text(folder / "m.msh", bytes));
  return read_gmsh(folder / "m.msh");
}

/// Returns the message without the file name.
std::string gmsh_error(const std::string& bytes, ErrorCode code) {
  const auto mesh = read_gmsh_bytes(bytes);
  if (mesh) return "read";
  EXPECT_EQ(int(mesh.error().code), int(code)) << mesh.error().message;
  const std::string& message = mesh.error().message;
  return message.substr(message.find("m.msh: ") + 7);
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(Gmsh, ReadsEveryShapeRegionAndSetFromTextAndBinary) {
  for (const VolumeMesh& mesh : some_meshes())
    for (const GmshForm form : {GmshForm::kText, GmshForm::kBinary}) {
      const auto read = read_gmsh_bytes(test::gmsh_file(mesh, form));
      ASSERT_TRUE(read) << read.error().message;
      EXPECT_EQ(read->nodes_L, mesh.nodes_L);
      EXPECT_EQ(read->region_names, mesh.region_names);
      EXPECT_EQ(read->node_sets, mesh.node_sets);
      EXPECT_EQ(read->face_sets, mesh.face_sets);
      ASSERT_EQ(read->blocks.size(), mesh.blocks.size());
      for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
        EXPECT_EQ(read->blocks[b].shape, mesh.blocks[b].shape);
        EXPECT_EQ(read->blocks[b].nodes, mesh.blocks[b].nodes);
        EXPECT_EQ(read->blocks[b].region, mesh.blocks[b].region);
      }
      EXPECT_TRUE(mesh::poor_elements(*read, 0.1).empty());
    }
}

/// A tetrahedron in a Gmsh file, with a node without element.
const std::string kOneTet =
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Comments\nby hand\n$EndComments\n"
    "$Nodes\n1 5 1 9\n3 1 0 5\n9\n1\n2\n3\n4\n5 5 5\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n$EndNodes\n"
    "$Elements\n1 1 1 1\n3 1 4 1\n1 1 2 3 4\n$EndElements\n";

TEST(Gmsh, OmitsNodesWithoutElementAndNeedsNoGroups) {
  const auto mesh = read_gmsh_bytes(kOneTet);
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->nodes_L, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}));
  EXPECT_EQ(mesh->blocks[0].nodes, (std::vector<std::int32_t>{0, 1, 2, 3}));
  EXPECT_EQ(mesh->blocks[0].region, (std::vector<std::int32_t>{0}));
  EXPECT_TRUE(mesh->node_sets.empty());
}

TEST(Gmsh, NamesGroupsWithoutANameAfterTheirTag) {
  VolumeMesh box = mesh::make_box(ElementShape::kHex8, {1, 1, 1}, kSize_mm);
  box.face_sets = {{"a", {box.face_sets.at("x1")}}};
  box.node_sets = {{"p", {0}}};
  std::string text = test::gmsh_file(box, GmshForm::kText);
  text = replaced(text, "$PhysicalNames\n2\n2 1 \"a\"\n0 1 \"p\"\n$EndPhysicalNames\n", "");
  const auto mesh = read_gmsh_bytes(text);
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->face_sets.count("surface 1"), 1U);
  EXPECT_EQ(mesh->node_sets.at("point 1"), (std::vector<std::int32_t>{0}));
}

TEST(Gmsh, ExplainsHowToConvertAnotherVersion) {
  const auto code = ErrorCode::kFileUnsupported;
  EXPECT_EQ(gmsh_error(replaced(kOneTet, "4.1 0 8", "2.2 0 8"), code),
            "Gmsh format 2.2 is not supported, only 4.1: convert it with gmsh OLD.msh -save "
            "-format msh41 "
            "-o NEW.msh, or set Mesh.MshFileVersion = 4.1");
  EXPECT_NE(gmsh_error(replaced(kOneTet, "4.1 0 8", "4 0 8"), code), "read");
  EXPECT_NE(gmsh_error(replaced(kOneTet, "4.1 0 8", "4.1 1 4"), code), "read");
  const std::string big = replaced(test::gmsh_file(some_meshes()[0], GmshForm::kBinary),
                                   std::string("8\n\1\0\0\0", 6), std::string("8\n\0\0\0\1", 6));
  EXPECT_EQ(gmsh_error(big, code), "it is big-endian, only little-endian is supported");
}

TEST(Gmsh, NamesUnsupportedElementTypes) {
  const auto code = ErrorCode::kFileUnsupported;
  EXPECT_EQ(
      gmsh_error(replaced(kOneTet, "3 1 4 1", "3 1 12 1"), code),
      "elements of Gmsh type 12 (27-node hexahedron) are not supported; quadratic elements must "
      "have nodes on edges only, Mesh.SecondOrderIncomplete = 1");
  for (const char* pyramid : {"3 1 14 1", "3 1 19 1"}) {
    const std::string reported = gmsh_error(replaced(kOneTet, "3 1 4 1", pyramid), code);
    EXPECT_NE(reported.find("with pyramids must be linear, Mesh.ElementOrder = 1"),
              std::string::npos)
        << reported;
  }
  const std::string cubic = gmsh_error(replaced(kOneTet, "3 1 4 1", "3 1 29 1"), code);
  EXPECT_NE(cubic.find("order must be 2 at most"), std::string::npos) << cubic;
  EXPECT_EQ(gmsh_error(replaced(kOneTet, "3 1 4 1", "3 1 777 1"), code).substr(0, 41),
            "elements of Gmsh type 777 (unknown) are n");
  EXPECT_EQ(gmsh_error(replaced(kOneTet, "$Nodes",
                                "$PartitionedEntities\n$EndPartitionedEntities\n"
                                "$Nodes"),
                       code)
                .substr(0, 23),
            "the mesh is partitioned");
}

TEST(Gmsh, RejectsMissingRepeatedAndNonFiniteNodes) {
  const auto code = ErrorCode::kFileCorrupt;
  EXPECT_EQ(gmsh_error(replaced(kOneTet, "1 1 2 3 4", "1 1 2 3 8"), code),
            "element 1 refers to node 8, which is missing");
  EXPECT_EQ(gmsh_error(replaced(kOneTet, "9\n1\n2\n", "9\n2\n2\n"), code),
            "node 2 is defined twice");
  EXPECT_EQ(gmsh_error(replaced(kOneTet, "0 1 0\n", "0 nan 0\n"), code),
            "node 3 has a coordinate that is not finite");
  EXPECT_EQ(gmsh_error(replaced(kOneTet, "0 1 0\n", "0 1e999 0\n"), code),
            "\"1e999\" is not a number");
}

TEST(Gmsh, RejectsCountsBeyondTheFileSize) {
  const auto code = ErrorCode::kFileCorrupt;
  EXPECT_EQ(gmsh_error(replaced(kOneTet, "3 1 0 5", "3 1 0 18446744073709551615"), code),
            "the file states 18446744073709551615 nodes in a block, more than fit into it");
  EXPECT_EQ(gmsh_error(replaced(kOneTet, "1 5 1 9", "1 4 1 9"), code),
            "there are 5 nodes, the file states 4");
  EXPECT_EQ(gmsh_error(replaced(kOneTet, "1 1 1 1\n", "1 2 1 1\n"), code),
            "there are 1 elements, the file states 2");
  EXPECT_NE(gmsh_error(replaced(kOneTet, "3 1 4 1", "3 1 4 -1"), code), "read");
  EXPECT_NE(gmsh_error(replaced(kOneTet, "3 1 4 1", "2 1 4 1"), code), "read");
  EXPECT_NE(gmsh_error(replaced(kOneTet, "$EndNodes", "7\n$EndNodes"), code), "read");
}

TEST(Gmsh, RejectsMissingAndRepeatedSections) {
  const auto code = ErrorCode::kFileCorrupt;
  const std::size_t elements = kOneTet.find("$Elements");
  EXPECT_EQ(gmsh_error(kOneTet.substr(0, elements), code),
            "nodes or elements are missing, expected both");
  EXPECT_EQ(gmsh_error(kOneTet + kOneTet.substr(elements), code),
            "there are two lists of elements");
  EXPECT_EQ(gmsh_error("", code), "not a Gmsh file: it does not begin with $MeshFormat");
  EXPECT_EQ(read_gmsh("/nonexistent.msh").error().code, ErrorCode::kFileNotFound);
}

TEST(Gmsh, RejectsNamedGroupsWithoutMembers) {
  std::string text = test::gmsh_file(some_meshes()[0], GmshForm::kText);
  const std::size_t from = text.find("$Entities"), to = text.find("$Nodes");
  text.erase(from, to - from);
  const std::string reported = gmsh_error(text, ErrorCode::kMeshInvalid);
  EXPECT_EQ(reported.substr(0, 25), "it names physical groups,") << reported;
  const std::size_t names = text.find("$PhysicalNames");
  text.erase(names, text.find("$Nodes") - names);
  EXPECT_TRUE(read_gmsh_bytes(text));  // One region and no set.
}

TEST(Gmsh, RejectsOverlappingGroupsAndGroupsOutsideVolumes) {
  VolumeMesh box = mesh::make_box(ElementShape::kHex8, {1, 1, 1}, kSize_mm);
  box.face_sets = {{"top", {box.face_sets.at("z1")}}};
  box.node_sets = {};
  const std::string good = test::gmsh_file(box, GmshForm::kText);
  ASSERT_TRUE(read_gmsh_bytes(good));
  const auto code = ErrorCode::kMeshInvalid;
  EXPECT_EQ(
      gmsh_error(replaced(good, "100 0 1 2 3 4 5 1 0 1 -7", "100 0 1 2 3 4 5 2 3 4 1 -7"), code),
      "volume 100 is in the physical groups 3 and 4, expected at most one");
  // The face's nodes 4, 7, 6, 5 with one of the bottom among them.
  EXPECT_EQ(gmsh_error(replaced(good, "2 43 ", "2 3 "), code).substr(0, 23),
            "physical group \"top\": t");
  EXPECT_NE(gmsh_error(replaced(kOneTet, "3 1 4 1\n1 1 2 3 4", "2 1 2 1\n1 1 2 3"), code), "read");
  box.node_sets = {{"TOP", {0}}};
  EXPECT_EQ(gmsh_error(replaced(test::gmsh_file(box, GmshForm::kText), "TOP", "top"), code),
            "two physical groups are named \"top\", the names of points, curves and surfaces must "
            "differ");
}

TEST(Gmsh, RejectsTruncationsOrReadsTheWholeMesh) {
  const VolumeMesh mesh = some_meshes()[2];
  for (const GmshForm form : {GmshForm::kText, GmshForm::kBinary}) {
    const std::string whole = test::gmsh_file(mesh, form);
    int rejected = 0;
    for (std::size_t size = 0; size < whole.size(); size += 7) {
      const auto read = read_gmsh_bytes(whole.substr(0, size));
      rejected += read ? 0 : 1;
      if (read) {
        EXPECT_EQ(read->element_count(), mesh.element_count()) << size;
      } else {
        EXPECT_EQ(read.error().message.find('\n'), std::string::npos);
      }
    }
    EXPECT_GT(rejected, 100);
  }
}

TEST(VolumeMeshFiles, AreReadByEnding) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_text(folder / "m.msh", kOneTet));
  ASSERT_TRUE(read_volume_mesh(folder / "m.msh"));
  ASSERT_TRUE(write_vtu(folder / "m.vtu", read_volume_mesh(folder / "m.msh").value()));
  EXPECT_EQ(read_volume_mesh(folder / "m.vtu").value().element_count(), 1);
  EXPECT_EQ(read_volume_mesh(folder / "m.inp").error().code, ErrorCode::kFileUnsupported);
}

}  // namespace
}  // namespace lefort::io::test_gmsh
