#include <lefort/core/check.h>
#include <lefort/field/build/build_distance_field.h>
#include <lefort/io/field_file.h>
#include <lefort/io/write_atomically.h>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <memory>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/field_bytes.h"
#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace lefort::io::test_field_file {
namespace {

using field::DistanceField;
using test::block_at;
using test::decode_copy;
using test::kBandAt;
using test::kBlocks;
using test::kCellAt;
using test::kClosedAt;
using test::kFindingsAt;
using test::kOriginAt;
using test::kPartsAt;
using test::kResolutionAt;
using test::kSmoothAt;
using test::kStorageAt;
using test::kToleranceAt;
using test::kTrianglesAt;
using test::kVersionAt;
using test::small_field;
using test::small_fields;
using test::small_octree;
using test::value_at;
using test::with_checksum;
using test::with_value;

std::vector<Vec3> points_around(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> in(-12, 12);
  std::vector<Vec3> points;
  for (int n = 0; n < count; ++n)
    points.emplace_back(in(random), in(random), in(random) / (1 + n % 3));
  return points;
}

void expect_same_answers(const DistanceField& a, const DistanceField& b) {
  ASSERT_EQ(a.is_smooth(), b.is_smooth());
  EXPECT_EQ(a.band_mm(), b.band_mm());
  EXPECT_EQ(a.frame().tolerance_mm, b.frame().tolerance_mm);
  EXPECT_EQ(a.frame().closed, b.frame().closed);
  EXPECT_EQ(a.sample_bytes(), b.sample_bytes());
  EXPECT_EQ(a.source(), b.source());
  for (const Vec3& p : points_around(1000, 1)) {
    EXPECT_EQ(a.sample(p).zone, b.sample(p).zone);
    EXPECT_EQ(a.sample(p).distance_mm, b.sample(p).distance_mm);
    EXPECT_EQ(a.sample(p).gradient_B, b.sample(p).gradient_B);
    if (!a.is_smooth()) continue;
    EXPECT_EQ(a.sample_smooth(p).zone, b.sample_smooth(p).zone);
    EXPECT_EQ(a.sample_smooth(p).distance_mm, b.sample_smooth(p).distance_mm);
    EXPECT_EQ(a.sample_smooth(p).hessian_B, b.sample_smooth(p).hessian_B);
  }
}

TEST(FieldFile, ReadsBackTheSameField) {
  const test::TemporaryFolder folder;
  for (const DistanceField& field : small_fields()) {
    ASSERT_TRUE(write_field(folder / "bone.field", field));
    const auto read = read_field(folder / "bone.field");
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->samples().index(), field.samples().index());
    EXPECT_EQ(encode_field(*read), encode_field(field));
    expect_same_answers(*read, field);
  }
}

TEST(FieldFile, PreservesAnOpenSurface) {
  const auto open =
      field::build_distance_field(test::make_sheet(10, 2), {.resolution = 32}).value();
  const auto read = decode_copy(encode_field(open));
  ASSERT_TRUE(read);
  EXPECT_FALSE(read->frame().closed);
  EXPECT_EQ(read->sample(Vec3(0, 0, 100)).zone, field::Zone::kUnknown);
}

TEST(FieldFile, HasTheDocumentedLayout) {
  const std::string bytes = encode_field(small_field());
  EXPECT_EQ(bytes.substr(0, 8), "lefortDF");
  EXPECT_EQ(value_at<std::uint32_t>(bytes, kVersionAt), 3U);
  EXPECT_EQ(value_at<std::uint32_t>(bytes, kStorageAt), 1U);
  EXPECT_EQ(value_at<std::int32_t>(bytes, kResolutionAt), 16);
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_EQ(value_at<double>(bytes, kOriginAt + 8 * k), small_field().frame().origin_B[int(k)]);
  EXPECT_EQ(value_at<double>(bytes, kCellAt), small_field().cell_mm());
  EXPECT_EQ(value_at<double>(bytes, kBandAt), 3.0);
  EXPECT_EQ(value_at<double>(bytes, kToleranceAt), small_field().frame().tolerance_mm);
  EXPECT_EQ(value_at<std::uint32_t>(bytes, kClosedAt), 1U);
  EXPECT_EQ(value_at<std::uint32_t>(bytes, kSmoothAt), 1U);
  EXPECT_EQ(block_at(bytes, kBlocks), bytes.size());

  // Reads one sample according to the document.
  const field::LatticePoint p = {13, 9, 8};
  const std::size_t table = block_at(bytes, 0), codes = block_at(bytes, 1);
  const std::size_t brick = std::size_t(((p[2] / 8 + 1) * 5 + p[1] / 8 + 1) * 5 + p[0] / 8 + 1);
  const auto first_leaf = value_at<std::uint32_t>(bytes, table + 8 * brick);
  const auto stored = value_at<std::uint8_t>(bytes, table + 8 * brick + 4);
  const int leaf = (p[0] / 4 & 1) + 2 * (p[1] / 4 & 1) + 4 * (p[2] / 4 & 1);
  ASSERT_NE(stored >> leaf & 1, 0);
  const std::size_t number =
      first_leaf + std::size_t(std::popcount(unsigned(stored) & ((1U << leaf) - 1)));
  const std::size_t at =
      codes + number * 192 + std::size_t((p[2] % 4 * 4 + p[1] % 4) * 4 + p[0] % 4) * 3;
  std::int32_t code = 0;
  std::memcpy(&code, bytes.data() + at, 3);
  if (code >= 1 << 23) code -= 1 << 24;
  EXPECT_NEAR(code * 3.0 / 8388606, small_field().cell(p).corners[0], 1e-6);
}

TEST(FieldFile, StoresItsSource) {
  // One finding of each kind that a triangle soup can have at the same time.
  geometry::TriangleMesh mesh = test::join(test::make_icosphere(9, 2), test::make_sheet(4, 1));
  std::swap(mesh.triangles[3][0], mesh.triangles[3][1]);
  mesh.triangles.push_back({5, 5, 7});
  mesh.triangles.push_back(mesh.triangles[9]);
  mesh.vertices.push_back(mesh.vertices[0]);
  const DistanceField field = field::build_distance_field(mesh, {.resolution = 32}).value();
  ASSERT_TRUE(field.source());
  const field::FieldSource& source = *field.source();
  EXPECT_EQ(source.triangles, 320 + 2);
  EXPECT_EQ(source.components, 2);
  EXPECT_EQ(source.report.flipped_triangles, 1);
  EXPECT_EQ(source.report.degenerate_triangles, 1);
  EXPECT_EQ(source.report.duplicate_triangles, 1);
  EXPECT_EQ(source.report.duplicate_vertices, 1);
  EXPECT_EQ(source.report.boundary_edges, 4);

  std::string bytes = encode_field(field);
  EXPECT_EQ(decode_copy(bytes)->source(), field.source());
  EXPECT_EQ(value_at<std::uint64_t>(bytes, kTrianglesAt), 322U);
  EXPECT_EQ(value_at<std::uint64_t>(bytes, kPartsAt), 2U);
  const std::vector<Index> findings = {1, 1, 1, 0, 1, 4, 0, 0};
  for (std::size_t n = 0; n < findings.size(); ++n)
    EXPECT_EQ(value_at<std::uint32_t>(bytes, kFindingsAt + 4 * n), findings[n]) << n;
  for (std::uint32_t n = 0; n < 8; ++n) bytes = with_value(bytes, kFindingsAt + 4 * n, n + 1);
  EXPECT_EQ(decode_copy(bytes)->source()->report,
            (field::MeshRepairReport{1, 2, 3, 4, 5, 6, 7, 8}));

  // Older files have zeros here.
  std::memset(bytes.data() + kFindingsAt, 0, 64);
  const auto older = decode_copy(with_checksum(bytes));
  ASSERT_TRUE(older);
  EXPECT_FALSE(older->source());
}

TEST(FieldFile, RequiresItsEnding) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(write_field(folder / "bone.vti", small_field()).error().code,
            ErrorCode::kInvalidArgument);
  EXPECT_EQ(folder.entry_count(), 0);
}

TEST(FieldFile, NamesUnreadableAndUnwritableFiles) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(read_field(folder / "none.field").error().code, ErrorCode::kFileNotFound);
  EXPECT_EQ(write_field("/nonexistent/a.field", small_field()).error().code,
            ErrorCode::kFileUnwritable);
  ASSERT_TRUE(write_text(folder / "text.field", "solid bone"));
  const auto foreign = read_field(folder / "text.field");
  EXPECT_EQ(foreign.error().code, ErrorCode::kFileUnsupported);
  EXPECT_NE(foreign.error().message.find("text.field"), std::string::npos);
}

TEST(FieldFile, RejectsPipesAndFoldersWithoutBlocking) {
  const test::TemporaryFolder folder;
  ASSERT_EQ(::mkfifo((folder / "pipe.field").c_str(), 0600), 0);
  std::filesystem::create_directory(folder / "folder.field");
  for (const char* name : {"pipe.field", "folder.field"}) {
    const auto read = read_field(folder / name);  // The pipe has no writer.
    ASSERT_FALSE(read) << name;
    EXPECT_EQ(read.error().code, ErrorCode::kFileNotFound);
    EXPECT_NE(read.error().message.find("regular file"), std::string::npos);
  }
  ASSERT_TRUE(write_text(folder / "empty.field", ""));
  EXPECT_EQ(read_field(folder / "empty.field").error().code, ErrorCode::kFileUnsupported);
  std::filesystem::create_symlink(folder / "nowhere", folder / "dangling.field");
  EXPECT_EQ(read_field(folder / "dangling.field").error().code, ErrorCode::kFileNotFound);
  EXPECT_EQ(read_field("/dev/zero").error().code, ErrorCode::kFileNotFound);
}

TEST(FieldFile, RemainsValidAfterTheFileIsRemoved) {
  for (const DistanceField& field : small_fields()) {
    auto folder = std::make_unique<test::TemporaryFolder>();
    ASSERT_TRUE(write_field(*folder / "bone.field", field));
    auto first = std::make_unique<DistanceField>(read_field(*folder / "bone.field").value());
    const DistanceField copy = *first;
    first.reset();
    folder.reset();  // Removes the file.
    expect_same_answers(copy, field);
  }
}

TEST(FieldFile, IsNotChangedByReplacingTheFile) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_field(folder / "bone.field", small_fields()[0]));
  const DistanceField read = read_field(folder / "bone.field").value();
  ASSERT_TRUE(write_field(folder / "bone.field", small_octree()));
  expect_same_answers(read, small_fields()[0]);
}

TEST(FieldFile, RejectsAnotherVersion) {
  for (const std::uint32_t version : {0U, 2U, 4U}) {
    const auto other = decode_copy(with_value(encode_field(small_field()), kVersionAt, version));
    ASSERT_FALSE(other);
    EXPECT_EQ(other.error().code, ErrorCode::kFileUnsupported);
    EXPECT_NE(other.error().message.find("version " + std::to_string(version)), std::string::npos);
  }
}

TEST(FieldFile, RequiresAlignedBytes) {
  const std::string good = encode_field(small_field());
  const auto words = std::make_shared<std::vector<std::uint64_t>>(good.size() / 8 + 2);
  const auto bytes = std::as_writable_bytes(std::span(*words));
  for (const std::size_t shift : {1, 4, 7}) {
    std::memcpy(bytes.data() + shift, good.data(), good.size());
    EXPECT_THROW(static_cast<void>(decode_field(bytes.subspan(shift, good.size()), words)),
                 LogicError);
  }
  std::memcpy(bytes.data(), good.data(), good.size());
  EXPECT_TRUE(decode_field(bytes.first(good.size()), words));
}

}  // namespace
}  // namespace lefort::io::test_field_file
