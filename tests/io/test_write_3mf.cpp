#include <lefort/io/read_text.h>
#include <lefort/io/write_3mf.h>

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace lefort::io {
namespace {

/// Python's zip and XML readers as independent ones: counts, first vertex, unit, title.
constexpr const char* kRead = R"(
import sys, zipfile, xml.etree.ElementTree as tree
archive = zipfile.ZipFile(sys.argv[1])
assert archive.testzip() is None
assert archive.namelist() == ['[Content_Types].xml', '_rels/.rels', '3D/3dmodel.model']
types, rels = tree.fromstring(archive.read('[Content_Types].xml')), tree.fromstring(archive.read('_rels/.rels'))
assert len(types) == 2 and rels[0].get('Target') == '/3D/3dmodel.model'
model = tree.fromstring(archive.read('3D/3dmodel.model'))
core = '{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}'
assert model.tag == core + 'model' and model.get('unit') == 'millimeter'
assert model.find(core + 'metadata').text == 'a <b> & c', model.find(core + 'metadata').text
vertices, triangles = list(model.iter(core + 'vertex')), list(model.iter(core + 'triangle'))
assert len(vertices) == int(sys.argv[2]) and len(triangles) == int(sys.argv[3])
assert abs(float(vertices[0].get('x')) - float(sys.argv[4])) < 1e-5
assert all(0 <= int(t.get(v)) < len(vertices) for t in triangles for v in ('v1', 'v2', 'v3'))
)";

TEST(Write3mf, is_read_by_others_and_has_no_time) {
  const test::TemporaryFolder folder;
  const geometry::TriangleMesh box = test::make_box(Vec3(1.0, 2.0, 3.0), Vec3(4.0, 6.0, 8.0));
  const auto first = folder.path() / "a.3mf", second = folder.path() / "b.3mf";
  ASSERT_TRUE(write_3mf(first, box, "a <b> & c"));
  ASSERT_TRUE(write_3mf(second, box, "a <b> & c"));
  const auto one = read_text(first, 1 << 20), other = read_text(second, 1 << 20);
  ASSERT_TRUE(one && other);
  EXPECT_EQ(*one, *other);
  const std::string command = "/usr/bin/python3 -c \"" + std::string(kRead) + "\" '" +
                              first.string() + "' " + std::to_string(box.vertices.size()) + " " +
                              std::to_string(box.triangles.size()) + " " +
                              std::to_string(box.vertices.front().x());
  EXPECT_EQ(std::system(command.c_str()), 0);
  EXPECT_FALSE(write_3mf(folder.path() / "c.3mf", {}, "nothing"));
  EXPECT_FALSE(write_3mf(folder.path() / "missing" / "d.3mf", box, "no folder"));
}

}  // namespace
}  // namespace lefort::io
