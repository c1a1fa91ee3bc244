/// \file
/// Thousands of damaged files for every reader of surfaces, fields, volume meshes, decks, points,
/// markups and transforms.
///
/// Every file gives a Result: no crash, no hang, and no NaN distance in a field built from it.
/// Every message contains the seed; number of files and time are limited.
#include <lefort/field/build/build_distance_field.h>
#include <lefort/field/query/lattice_samples.h>
#include <lefort/io/deck_file.h>
#include <lefort/io/field_file.h>
#include <lefort/io/landmarks_file.h>
#include <lefort/io/markups_file.h>
#include <lefort/io/plan_file.h>
#include <lefort/io/point_table.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/transform_file.h>
#include <lefort/io/volume_mesh_files.h>
#include <lefort/io/vtu.h>
#include <lefort/mesh/box_grid.h>
#include <lefort/solve/prepare_deck.h>

#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <iterator>
#include <memory>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "fuzz/damaged.h"
#include "io/gmsh_writer.h"
#include "support/box_mesh.h"
#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace lefort::io::test_fuzz {
namespace {

using geometry::TriangleMesh;
using test::run_seeds;

std::string read_bytes(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Words that may break parsers: numbers that are too large, too small or invalid, and keywords of
/// the formats.
constexpr std::string_view kTokens[] = {"nan",
                                        "-inf",
                                        "1e999",
                                        "-1",
                                        "0",
                                        "4294967295",
                                        "2147483648",
                                        "99999999999999999999",
                                        "1e-320",
                                        "solid ",
                                        "endfacet\n",
                                        "facet normal 0 0 0\n",
                                        "outer loop\n",
                                        "vertex 1e38 1e38 1e38\n",
                                        "f 1 2 -1\n",
                                        "f 1//1 2//2 999999//3\n",
                                        "v 0 0 1e300\n",
                                        "element face 1000000000\n",
                                        "property list uchar int vertex_indices\n",
                                        "format ascii 1.0\n",
                                        "end_header\n",
                                        "<DataArray",
                                        "NumberOfPoints=\"-5\"",
                                        "offset=\"99999999\"",
                                        "encoding=\"base64\"",
                                        "</VTKFile>",
                                        "Name=\"set:x0\"",
                                        "$EndNodes\n",
                                        "$Elements\n",
                                        "4.1 0 8",
                                        "18446744073709551615 ",
                                        "\r\n",
                                        "\n",
                                        "\\\n",
                                        " "};

std::string damaged(std::string bytes, std::mt19937& random) {
  return test::damaged(std::move(bytes), kTokens, random);
}

void expect_numbers(const field::DistanceField& field, std::mt19937& random) {
  const Box3 box = field.box_B();
  std::uniform_real_distribution<double> in(-0.05, 1.05);
  for (int n = 0; n < 60; ++n) {
    const Vec3 p = box.min() + box.sizes().cwiseProduct(Vec3(in(random), in(random), in(random)));
    const field::FieldSample sample = field.sample(p);
    ASSERT_LE(int(sample.zone), int(field::Zone::kUnknown));
    ASSERT_TRUE(std::isfinite(sample.distance_mm) && sample.gradient_B.allFinite())
        << p.transpose();
    if (field.is_smooth()) {
      ASSERT_LE(int(field.sample_smooth(p).zone), int(field::Zone::kUnknown));
    }
  }
}

/// A small surface in all formats.
TriangleMesh any_surface(unsigned seed) {
  switch (seed % 3) {
    case 0:
      return test::make_box(Vec3(-1, -2, -3), Vec3(4, 5, 6));
    case 1:
      return test::make_torus(6, 2, 6, 4);
    default:
      return test::make_sheet(10, 2);
  }
}

void fuzz_surface(const std::string& ending, const std::vector<std::string>& more = {}) {
  const test::TemporaryFolder folder;
  std::vector<std::string> files = more;
  for (unsigned n = 0; n < 3; ++n) {
    ASSERT_TRUE(write_surface(folder / ("good" + ending), any_surface(n)));
    files.push_back(read_bytes(folder / ("good" + ending)));
  }
  int read = 0, built = 0;
  run_seeds(1500, [&](unsigned seed) {
    std::mt19937 random(seed);
    const std::filesystem::path path = folder / ("bad" + ending);
    std::filesystem::remove(path);  // Overwriting files is slow on some disks.
    std::ofstream(path, std::ios::binary) << damaged(files[seed % files.size()], random);
    const auto surface = read_surface(path);
    if (!surface) {
      ASSERT_FALSE(surface.error().message.empty());
      return;
    }
    ++read;
    constexpr field::FieldMethod kMethods[] = {
        field::FieldMethod::kBricks, field::FieldMethod::kHybrid, field::FieldMethod::kAdaptive,
        field::FieldMethod::kUniform};
    const auto field = field::build_distance_field(
        *surface, {.method = kMethods[seed % 4], .resolution = 16, .smooth = seed % 7 == 0});
    if (!field) {
      ASSERT_EQ(field.error().code, ErrorCode::kMeshInvalid) << field.error().message;
      return;
    }
    ++built;
    expect_numbers(*field, random);
  });
  EXPECT_GT(read, 5);
  EXPECT_GT(built, 5);
}

TEST(Fuzz, StlInBinaryAndText) {
  fuzz_surface(".stl",
               {"solid bone\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 9 0 0\n"
                "vertex 0 9 0\nendloop\nendfacet\nfacet normal 0 0 1\nouter loop\nvertex 9 0 0\n"
                "vertex 9 9 2\nvertex 0 9 0\nendloop\nendfacet\nendsolid bone\n"});
}

TEST(Fuzz, Obj) {
  fuzz_surface(".obj", {"# SPACE=RAS\nv 0 0 0\nv 1e1 0 0 1\nv 0 10 0\nv 0 0 10\nvt 0 0\n"
                        "vn 0 0 1\nf 1/1/1 2/1/1 3/1/1 4/1/1\nf -1 -2 \\\n-3\n"});
}

TEST(Fuzz, Ply) {
  fuzz_surface(".ply", {"ply\nformat ascii 1.0\ncomment SPACE=LPS\nelement vertex 4\n"
                        "property float x\nproperty float y\nproperty float z\nelement face 2\n"
                        "property list uchar int vertex_indices\nend_header\n0 0 0\n9 0 0\n"
                        "0 9 0\n0 0 9\n3 0 1 2\n4 0 1 2 3\n"});
}

TEST(Fuzz, Vtp) { fuzz_surface(".vtp"); }

/// Checks that all indices of an accepted mesh are in range.
void expect_sound(const mesh::VolumeMesh& mesh) {
  const auto exists = [&](std::int32_t node) { return node >= 0 && node < mesh.node_count(); };
  for (const mesh::ElementBlock& block : mesh.blocks) {
    ASSERT_EQ(Index(block.nodes.size()), block.element_count() * mesh::node_count(block.shape));
    ASSERT_TRUE(std::all_of(block.nodes.begin(), block.nodes.end(), exists));
  }
  for (const auto& [name, nodes] : mesh.node_sets) {
    ASSERT_TRUE(std::all_of(nodes.begin(), nodes.end(), exists));
    ASSERT_TRUE(std::is_sorted(nodes.begin(), nodes.end()));
  }
  for (const auto& [name, faces] : mesh.face_sets)
    for (const mesh::Face& face : faces) {
      const auto nodes = nodes_of(face);
      ASSERT_TRUE(std::all_of(nodes.begin(), nodes.end(), exists));
    }
}

void fuzz_volume_mesh(const std::string& ending, const std::vector<std::string>& files) {
  const test::TemporaryFolder folder;
  int read = 0;
  run_seeds(6000, [&](unsigned seed) {
    std::mt19937 random(seed);
    const std::filesystem::path path = folder / ("bad" + ending);
    std::filesystem::remove(path);
    std::ofstream(path, std::ios::binary) << damaged(files[seed % files.size()], random);
    const auto mesh = read_volume_mesh(path);
    if (mesh) {
      ++read;
      expect_sound(*mesh);
    } else {
      ASSERT_EQ(mesh.error().message.find('\n'), std::string::npos);
    }
  });
  EXPECT_GT(read, 5);
}

/// Small meshes of all shapes, with sets.
std::vector<mesh::VolumeMesh> some_volume_meshes() {
  return {mesh::make_mixed_box(mesh::BoxMix::kAllLinear, {4, 1, 1}, {4, 1, 1}),
          mesh::make_mixed_box(mesh::BoxMix::kHex20Wedge15, {2, 1, 1}, {2, 1, 1}),
          mesh::make_box(mesh::ElementShape::kTet10, {1, 1, 1}, {1, 1, 1})};
}

TEST(Fuzz, VtuVolumeMeshes) {
  const test::TemporaryFolder folder;
  std::vector<std::string> files;
  for (const mesh::VolumeMesh& mesh : some_volume_meshes()) {
    ASSERT_TRUE(write_vtu(folder / "good.vtu", mesh, {}, VtuFaces::kWrite));
    files.push_back(read_bytes(folder / "good.vtu"));
  }
  fuzz_volume_mesh(".vtu", files);
}

TEST(Fuzz, GmshInTextAndBinary) {
  std::vector<std::string> files;
  for (const mesh::VolumeMesh& mesh : some_volume_meshes())
    for (const test::GmshForm form : {test::GmshForm::kText, test::GmshForm::kBinary})
      files.push_back(test::gmsh_file(mesh, form));
  fuzz_volume_mesh(".msh", files);
}

TEST(Fuzz, TablesOfPoints) {
  int read = 0;
  run_seeds(5000, [&](unsigned seed) {
    std::mt19937 random(seed);
    const auto points =
        parse_points(damaged("x,y,z\n1,2,3\n# a comment\n-4.5e1 6 7 8\n1;2;3\n", random));
    if (!points) return;
    ++read;
    for (const Vec3& p : *points) ASSERT_TRUE(p.allFinite());
  });
  EXPECT_GT(read, 5);
}

TEST(Fuzz, LandmarksMarkupsAndTransforms) {
  const std::string markups =
      R"({"markups": [{"type": "Fiducial", "coordinateSystem": "RAS", "coordinateUnits": "mm",
          "controlPoints": [{"label": "A", "position": [1, 2, 3], "positionStatus": "defined"}]}]})";
  const std::string transform =
      "#Insight Transform File V1.0\n#Transform 0\nTransform: AffineTransform_double_3_3\n"
      "Parameters: 1 0 0 0 1 0 0 0 1 3 4 5\nFixedParameters: 0 0 0\n";
  int read = 0;
  run_seeds(3000, [&](unsigned seed) {
    std::mt19937 random(seed);
    if (const auto marked = parse_markups(damaged(markups, random))) {
      ++read;
      for (const Markup& markup : *marked)
        for (const plan::Landmark& point : markup.points) ASSERT_TRUE(point.point_L.allFinite());
    }
    if (const auto table = parse_landmark_table(
            damaged("name,x_mm,y_mm,z_mm\nA,1,2,3\n\"B, C\",-4.5e1,6,7\n", random))) {
      ++read;
      for (const plan::Landmark& point : *table) ASSERT_TRUE(point.point_L.allFinite());
    }
    if (const auto motion = parse_transform(damaged(transform, random))) {
      ++read;
      ASSERT_TRUE(motion->matrix().allFinite());
      ASSERT_NEAR(motion->linear().determinant(), 1.0, 1e-9);
    }
  });
  EXPECT_GT(read, 50);
}

TEST(Fuzz, FieldFilesWithAValidChecksum) {
  std::vector<std::string> files;
  for (const field::FieldMethod method :
       {field::FieldMethod::kBricks, field::FieldMethod::kHybrid, field::FieldMethod::kAdaptive,
        field::FieldMethod::kUniform})
    for (const bool smooth : {false, true})
      files.push_back(encode_field(
          field::build_distance_field(any_surface(unsigned(files.size())),
                                      {.method = method, .resolution = 16, .smooth = smooth})
              .value()));
  int accepted = 0;
  run_seeds(20'000, [&](unsigned seed) {
    std::mt19937 random(seed);
    std::string bytes = files[seed % files.size()];
    // Half of the damage is in the header of 192 bytes.
    if (seed / files.size() % 2 == 0) {
      std::string header = damaged(bytes.substr(0, 192), random);
      header.resize(192);
      bytes.replace(0, 192, header);
      std::memcpy(bytes.data(), "lefortDF\2\0\0", 12);
    } else {
      bytes = bytes.substr(0, 192) + damaged(bytes.substr(192), random);
    }
    std::memset(bytes.data() + 12, 0, 4);
    const auto checksum = std::uint32_t(
        ::crc32_z(0, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
    std::memcpy(bytes.data() + 12, &checksum, sizeof(checksum));

    const auto words = std::make_shared<std::vector<std::uint64_t>>((bytes.size() + 7) / 8);
    std::memcpy(words->data(), bytes.data(), bytes.size());
    const auto field = decode_field(std::as_bytes(std::span(*words)).first(bytes.size()), words);
    if (!field) return;
    ++accepted;
    expect_numbers(*field, random);
    if (const Index points = field->frame().resolution + 1; points <= 65) {
      ASSERT_EQ(field::count_samples(*field).value().total(), points * points * points);
    }
    ASSERT_FALSE(encode_field(*field).empty());
  });
  EXPECT_GT(accepted, 20);
}

/// Every kind of deck entry, for a block of six tetrahedra.
constexpr std::string_view kDeck = R"({"lefort_deck":1,"title":"t","mesh":"m.vtu","mm_per_unit":2,
"sets":{"a":{"box_mm":[[0,0,0],[1,1,0]]},"b":{"plane":{"point_mm":[0,0,1],"normal":[0,0,1]}},
"c":{"nodes":[4,5]},"d":{"nearest_mm":[1,1,1]},"e":{"region":0}},
"materials":[{"region":0,"law":"neo-hookean","young_kpa":9,"poisson":0.3,"density_kg_m3":5},
{"law":"linear-elastic","mu_kpa":4,"lambda_kpa":5}],
"displacements":[{"set":"a","x_mm":0,"y_mm":0,"z_mm":0},{"set":"d","z_mm":1,"curve":[[0,0],[1,1]]}],
"motions":[{"set":"c","keyframes":[{"time":1,"rotation_deg":[0,0,0]}]}],
"tractions":[{"faces":"b","traction_kpa":[1,2,3],"curve":[[0,0],[0.5,1]]}],
"pressures":[{"faces":"z1","pressure_kpa":4}],
"body_forces":[{"region":"0","acceleration_m_s2":[0,0,-9]}],
"obstacles":[{"name":"o","file":"o.stl","faces":"b","keyframes":[{"translation_mm":[0,0,1]}]}],
"steps":{"initial_increment":0.25,"min_increment":0.01,"max_increment":0.5,"times":[0.3]},
"newton":{"relative_tolerance":1e-7,"max_iterations":9},
"probes":[{"name":"p","node":5},{"name":"q","point_mm":[0.5,0.5,0.5]}],
"output":{"every":"times","fields":["displacement"]}})";

/// Values and keys of decks for use in wrong places.
constexpr std::string_view kDeckTokens[] = {"null",
                                            "true",
                                            "-1",
                                            "1e308",
                                            "-0.0",
                                            "1e30",
                                            "9223372036854775807",
                                            "\"\"",
                                            "[]",
                                            "{}",
                                            "[[]]",
                                            "\"a\"",
                                            "\"region\":1e30,",
                                            "\"node\":3,",
                                            "[0,0,0]",
                                            "\"z0\"",
                                            "\"neo-hookean\""};

TEST(Fuzz, DeepNestingInDecksAndPlans) {
  for (const std::string_view begin : {"[", R"({"a":)", R"([{"a":[)"})
    for (const std::size_t depth : {std::size_t(40), std::size_t(300000)}) {
      std::string nest;
      for (std::size_t n = 0; n < depth; ++n) nest += begin;
      std::string closed = nest + "1";
      for (auto at = nest.rbegin(); at != nest.rend(); ++at)
        if (*at == '[' || *at == '{') closed += *at == '[' ? ']' : '}';
      for (const std::string& value : {nest, closed}) {
        const std::string text = R"({"lefort_deck":1,"title":)" + value + R"(,"mesh":"m.vtu"})";
        const auto deck = parse_deck(text, "/nowhere");
        const auto plan = parse_plan(text, "/nowhere");
        ASSERT_FALSE(deck || plan);
        ASSERT_EQ(deck.error().message.find('\n'), std::string::npos);
      }
      const auto whole = parse_deck(closed, "/nowhere");
      ASSERT_FALSE(whole);
      ASSERT_NE(whole.error().message.find("nested more than"), std::string::npos);
    }
}

TEST(Fuzz, DecksAndTheirMeshReferences) {
  const mesh::VolumeMesh block = test::box_mesh({.cells = {1, 1, 1}});
  int read = 0, accepted = 0;
  run_seeds(20'000, [&](unsigned seed) {
    std::mt19937 random(seed);
    std::string text(kDeck);
    if (seed % 4 == 0) {
      text = damaged(text, random);
    } else {  // Replaces a value; the result is still JSON.
      const std::size_t at = text.find_first_of(":[,", random() % text.size());
      if (at == std::string::npos) return;
      const std::size_t end = text.find_first_of(",]}", at + 1);
      text.replace(at + 1, end - at - 1, kDeckTokens[random() % std::size(kDeckTokens)]);
    }
    const auto deck = parse_deck(text, "/nowhere");
    if (!deck) {
      ASSERT_FALSE(deck.error().message.empty());
      ASSERT_EQ(deck.error().message.find('\n'), std::string::npos);
      return;
    }
    ++read;
    const auto prepared = solve::prepare_deck(block, deck->deck);
    if (!prepared) {
      ASSERT_FALSE(prepared.error().message.empty());
      return;
    }
    ++accepted;
    ASSERT_EQ(prepared->levels.back(), 1.0);
    for (const auto& held : solve::prescribed_at(*prepared, 0.7))
      ASSERT_TRUE(std::isfinite(held.displacement_mm));
  });
  EXPECT_GT(read, 5);
  EXPECT_GT(accepted, 0);
}

}  // namespace
}  // namespace lefort::io::test_fuzz
