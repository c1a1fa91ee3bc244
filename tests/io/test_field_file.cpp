#include <lefort/core/check.h>
#include <lefort/field/build/build_distance_field.h>
#include <lefort/io/field_file.h>
#include <lefort/io/write_atomically.h>

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <zlib.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace lefort::io {
namespace {

// Offsets in the header (docs/field-format.md).
constexpr std::size_t kVersionAt = 8, kChecksumAt = 12, kStorageAt = 16, kResolutionAt = 20;
constexpr std::size_t kOriginAt = 24, kCellAt = 48, kBandAt = 56, kToleranceAt = 64;
constexpr std::size_t kClosedAt = 72, kSmoothAt = 76, kBlockBytesAt = 80, kFindingsAt = 128;
constexpr std::size_t kTrianglesAt = 160, kPartsAt = 168;
constexpr std::size_t kHeaderBytes = 192, kAlignment = 64, kBlocks = 6;

using field::DistanceField;
using field::FieldMethod;

constexpr FieldMethod kMethods[] = {FieldMethod::kBricks, FieldMethod::kHybrid,
                                    FieldMethod::kUniform};

/// One of each storage, with and without a smooth lattice.
const std::vector<DistanceField>& small_fields() {
  static const std::vector<DistanceField> fields = [] {
    std::vector<DistanceField> all;
    for (const FieldMethod method : kMethods)
      for (const bool smooth : {false, true})
        all.push_back(field::build_distance_field(
                          test::make_torus(6, 2, 24, 12),
                          {.method = method, .resolution = 16, .band_mm = 3.0, .smooth = smooth})
                          .value());
    return all;
  }();
  return fields;
}
const DistanceField& small_field() { return small_fields()[1]; }  // Bricks and a smooth lattice.
const DistanceField& small_octree() { return small_fields()[3]; }

/// Bytes in memory aligned as decode_field() wants them, gone when the field is.
Result<DistanceField> decode(std::string_view bytes) {
  const auto words = std::make_shared<std::vector<std::uint64_t>>((bytes.size() + 7) / 8 + 1);
  std::memcpy(words->data(), bytes.data(), bytes.size());
  return decode_field(std::as_bytes(std::span(*words)).first(bytes.size()), words);
}

/// A file whose checksum is right: what an attacker, not a failing disk, would write.
std::string sealed(std::string bytes) {
  std::memset(bytes.data() + kChecksumAt, 0, 4);
  const auto crc = std::uint32_t(
      ::crc32_z(0, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
  std::memcpy(bytes.data() + kChecksumAt, &crc, sizeof(crc));
  return bytes;
}

template <class T>
std::string with(std::string bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof(value));
  return sealed(std::move(bytes));
}

template <class T>
T value_at(const std::string& bytes, std::size_t at) {
  T value{};
  std::memcpy(&value, bytes.data() + at, sizeof(value));
  return value;
}

/// Where a block begins.
std::size_t block_at(const std::string& bytes, std::size_t block) {
  std::size_t begin = kHeaderBytes;
  for (std::size_t b = 0; b < block; ++b)
    begin += (value_at<std::uint64_t>(bytes, kBlockBytesAt + 8 * b) + kAlignment - 1) / kAlignment *
             kAlignment;
  return begin;
}

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

TEST(FieldFile, ReadsBackWhatWasWritten) {
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

TEST(FieldFile, AnOpenSurfaceStaysOpen) {
  const auto open =
      field::build_distance_field(test::make_sheet(10, 2), {.resolution = 32}).value();
  const auto read = decode(encode_field(open));
  ASSERT_TRUE(read);
  EXPECT_FALSE(read->frame().closed);
  EXPECT_EQ(read->sample(Vec3(0, 0, 100)).zone, field::Zone::kUnknown);
}

TEST(FieldFile, IsLaidOutAsDocumented) {
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

  // Reading one sample by hand, as the document says.
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

TEST(FieldFile, ReportsWhatItWasMadeOf) {
  // One finding of each kind that a soup can have at once.
  geometry::TriangleMesh mesh = test::join(test::make_icosphere(9, 2), test::make_sheet(4, 1));
  std::swap(mesh.triangles[3][0], mesh.triangles[3][1]);
  mesh.triangles.push_back({5, 5, 7});
  mesh.triangles.push_back(mesh.triangles[9]);
  mesh.vertices.push_back(mesh.vertices[0]);
  const DistanceField field = field::build_distance_field(mesh, {.resolution = 32}).value();
  ASSERT_TRUE(field.source());
  const field::FieldSource& source = *field.source();
  EXPECT_EQ(source.triangles, 320 + 2);
  EXPECT_EQ(source.parts, 2);
  EXPECT_EQ(source.report.flipped_triangles, 1);
  EXPECT_EQ(source.report.collapsed_triangles, 1);
  EXPECT_EQ(source.report.repeated_triangles, 1);
  EXPECT_EQ(source.report.repeated_vertices, 1);
  EXPECT_EQ(source.report.boundary_edges, 4);

  std::string bytes = encode_field(field);
  EXPECT_EQ(decode(bytes)->source(), field.source());
  EXPECT_EQ(value_at<std::uint64_t>(bytes, kTrianglesAt), 322U);
  EXPECT_EQ(value_at<std::uint64_t>(bytes, kPartsAt), 2U);
  const std::vector<Index> findings = {1, 1, 1, 0, 1, 4, 0, 0};
  for (std::size_t n = 0; n < findings.size(); ++n)
    EXPECT_EQ(value_at<std::uint32_t>(bytes, kFindingsAt + 4 * n), findings[n]) << n;
  for (std::uint32_t n = 0; n < 8; ++n) bytes = with(bytes, kFindingsAt + 4 * n, n + 1);
  EXPECT_EQ(decode(bytes)->source()->report, (field::MeshRepairReport{1, 2, 3, 4, 5, 6, 7, 8}));

  // Files from before this was told hold zeros there.
  std::memset(bytes.data() + kFindingsAt, 0, 64);
  const auto older = decode(sealed(bytes));
  ASSERT_TRUE(older);
  EXPECT_FALSE(older->source());
}

TEST(FieldFile, WantsItsEnding) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(write_field(folder / "bone.vti", small_field()).error().code,
            ErrorCode::kInvalidArgument);
  EXPECT_EQ(folder.entry_count(), 0);
}

TEST(FieldFile, NamesTheFileThatCannotBeReadOrWritten) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(read_field(folder / "none.field").error().code, ErrorCode::kFileNotFound);
  EXPECT_EQ(write_field("/nonexistent/a.field", small_field()).error().code,
            ErrorCode::kFileUnwritable);
  ASSERT_TRUE(write_text(folder / "text.field", "solid bone"));
  const auto foreign = read_field(folder / "text.field");
  EXPECT_EQ(foreign.error().code, ErrorCode::kFileUnsupported);
  EXPECT_NE(foreign.error().message.find("text.field"), std::string::npos);
}

TEST(FieldFile, RefusesWhatIsNoRegularFileWithoutWaiting) {
  const test::TemporaryFolder folder;
  ASSERT_EQ(::mkfifo((folder / "pipe.field").c_str(), 0600), 0);
  std::filesystem::create_directory(folder / "folder.field");
  for (const char* name : {"pipe.field", "folder.field"}) {
    const auto read = read_field(folder / name);  // Nobody will ever write to the pipe.
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

TEST(FieldFile, OutlivesTheFileAndTheFieldItCameFrom) {
  for (const DistanceField& field : small_fields()) {
    auto folder = std::make_unique<test::TemporaryFolder>();
    ASSERT_TRUE(write_field(*folder / "bone.field", field));
    auto first = std::make_unique<DistanceField>(read_field(*folder / "bone.field").value());
    const DistanceField copy = *first;
    first.reset();
    folder.reset();  // Deletes the file.
    expect_same_answers(copy, field);
  }
}

TEST(FieldFile, AReplacedFileDoesNotChangeAFieldThatWasRead) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_field(folder / "bone.field", small_fields()[0]));
  const DistanceField read = read_field(folder / "bone.field").value();
  ASSERT_TRUE(write_field(folder / "bone.field", small_octree()));
  expect_same_answers(read, small_fields()[0]);
}

TEST(FieldFile, RefusesAnotherVersion) {
  for (const std::uint32_t version : {0U, 2U, 4U}) {
    const auto other = decode(with(encode_field(small_field()), kVersionAt, version));
    ASSERT_FALSE(other);
    EXPECT_EQ(other.error().code, ErrorCode::kFileUnsupported);
    EXPECT_NE(other.error().message.find("version " + std::to_string(version)), std::string::npos);
  }
}

TEST(FieldFile, RefusesEveryTruncation) {
  for (const DistanceField& field : small_fields()) {
    const std::string whole = encode_field(field);
    // Every length of the header, and many of the rest.
    for (std::size_t size = 0; size < whole.size();
         size += size < 2 * kHeaderBytes ? 1 : 1 + whole.size() / 500) {
      const auto cut = decode(std::string_view(whole).substr(0, size));
      ASSERT_FALSE(cut) << size;
      EXPECT_EQ(cut.error().code, size < 8 ? ErrorCode::kFileUnsupported : ErrorCode::kFileCorrupt);
      // With a right checksum, too.
      if (size < kHeaderBytes) continue;
      EXPECT_FALSE(decode(sealed(whole.substr(0, size)))) << size;
    }
    EXPECT_FALSE(decode(whole + '\0'));
    EXPECT_FALSE(decode(sealed(whole + std::string(64, '\0'))));
  }
}

TEST(FieldFile, RefusesEveryFlippedBit) {
  for (const DistanceField& field : small_fields()) {
    std::string bytes = encode_field(field);
    std::mt19937 random(2);
    for (int n = 0; n < 500; ++n) {
      // Half of them in the header, where they do most harm.
      const std::size_t at = random() % (n % 2 == 0 ? kHeaderBytes : bytes.size());
      const char flip = char(1 << (random() % 8));
      bytes[at] = char(bytes[at] ^ flip);
      EXPECT_FALSE(decode(bytes)) << "byte " << at;
      bytes[at] = char(bytes[at] ^ flip);
    }
    EXPECT_TRUE(decode(bytes));
  }
}

/// Asks a field everything; answers may be nonsense, but must be answers.
void query(const DistanceField& field, std::mt19937& random) {
  const Box3 box = field.box_B();
  std::uniform_real_distribution<double> in(-0.05, 1.05);
  std::vector<Vec3> points;
  for (int n = 0; n < 200; ++n)  // Enough for the vector kernels.
    points.push_back(box.min() +
                     box.sizes().cwiseProduct(Vec3(in(random), in(random), in(random))));
  points.push_back(box.min());
  points.push_back(box.max());
  std::vector<field::FieldSample> samples(points.size());
  field.sample(points, samples);
  std::vector<float> distances(points.size());
  field.distances(points, distances);
  for (std::size_t i = 0; i < points.size(); ++i) {
    ASSERT_LE(int(samples[i].zone), int(field::Zone::kUnknown));
    if (samples[i].zone == field::Zone::kBand) {
      ASSERT_TRUE(std::isfinite(samples[i].distance_mm)) << points[i].transpose();
    }
    if (field.is_smooth()) {
      ASSERT_LE(int(field.sample_smooth(points[i]).zone), int(field::Zone::kUnknown));
    }
    static_cast<void>(field.nearest_point(points[i]));
  }
}

TEST(FieldFile, SurvivesForgedFilesWithARightChecksum) {
  std::mt19937 random(3);
  int accepted = 0;
  for (const DistanceField& field : small_fields()) {
    const std::string good = encode_field(field);
    for (int n = 0; n < 700; ++n) {
      std::string forged = good;
      for (auto edits = 1 + random() % 4; edits > 0; --edits) {
        const std::size_t at =
            kChecksumAt + 4 + random() % ((n % 2 == 0 ? kHeaderBytes : forged.size()) - 16);
        forged[at] = char(random() % 256);
      }
      const auto read = decode(sealed(forged));
      if (!read) {
        EXPECT_EQ(read.error().code, ErrorCode::kFileCorrupt);
        continue;
      }
      ++accepted;
      query(*read, random);  // Most are refused; the others must be harmless.
      ASSERT_FALSE(HasFatalFailure()) << "file " << n << " of storage " << field.samples().index();
    }
  }
  EXPECT_GT(accepted, 100);
}

TEST(FieldFile, SurvivesBlocksSwappedAndShortened) {
  // Sizes that fit together, of blocks that do not belong together.
  std::mt19937 random(4);
  std::vector<std::string> files;
  for (const DistanceField& field : small_fields()) files.push_back(encode_field(field));
  for (int n = 0; n < 2000; ++n) {
    std::string header = files[random() % files.size()].substr(0, kHeaderBytes), rest;
    if (random() % 3 == 0) header[kStorageAt] = char(random() % 5);
    for (std::size_t b = 0; b < kBlocks; ++b) {
      const std::string& from = files[random() % files.size()];
      const auto whole = value_at<std::uint64_t>(from, kBlockBytesAt + 8 * b);
      const std::uint64_t size = random() % 4 == 0 && whole > 0 ? random() % whole : whole;
      std::string block = from.substr(block_at(from, b), size);
      block.resize((size + kAlignment - 1) / kAlignment * kAlignment);
      std::memcpy(header.data() + kBlockBytesAt + 8 * b, &size, sizeof(size));
      rest += block;
    }
    const auto read = decode(sealed(header + rest));
    if (!read) continue;
    query(*read, random);
    ASSERT_FALSE(HasFatalFailure()) << n;
  }
}

std::string complaint(const std::string& bytes) {
  const auto read = decode(bytes);
  if (read) return "accepted";
  EXPECT_EQ(read.error().code, ErrorCode::kFileCorrupt);
  return read.error().message;
}

bool has(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }

TEST(FieldFile, SaysWhatIsWrongWithAForgedHeader) {
  const std::string good = encode_field(small_field());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(has(complaint(with(good, kResolutionAt, 17)), "resolution is 17"));
  EXPECT_TRUE(has(complaint(with(good, kResolutionAt, 1 << 20)), "resolution"));
  EXPECT_TRUE(has(complaint(with(good, kResolutionAt, -16)), "resolution"));
  EXPECT_TRUE(has(complaint(with(good, kResolutionAt, 8)), "table has"));
  EXPECT_TRUE(has(complaint(with(encode_field(small_octree()), kResolutionAt, 8)), "no tree"));
  EXPECT_TRUE(
      has(complaint(with(encode_field(small_fields()[4]), kResolutionAt, 8)), "bytes of samples"));
  EXPECT_TRUE(has(complaint(with(good, kCellAt, nan)), "cells are nan"));
  EXPECT_TRUE(has(complaint(with(good, kCellAt, -1.0)), "cells are -1"));
  EXPECT_TRUE(has(complaint(with(good, kBandAt, 1e9)), "band"));
  EXPECT_TRUE(has(complaint(with(good, kBandAt, 0.0)), "band"));
  EXPECT_TRUE(has(complaint(with(good, kOriginAt, nan)), "origin"));
  EXPECT_TRUE(has(complaint(with(good, kOriginAt + 16, 1e300)), "origin"));
  EXPECT_TRUE(has(complaint(with(good, kToleranceAt, nan)), "tolerance"));
  EXPECT_TRUE(has(complaint(with(good, kToleranceAt, -1.0)), "tolerance"));
  for (const double absurd : {1e-300, 1e-9, 1e7, 1e300})
    EXPECT_TRUE(has(complaint(with(good, kCellAt, absurd)), "cells are")) << absurd;
  EXPECT_TRUE(has(complaint(with(good, kBandAt, 0.9 * small_field().cell_mm())), "band"));
  EXPECT_TRUE(has(complaint(with(good, kTrianglesAt, ~std::uint64_t(0))), "triangles"));
  EXPECT_TRUE(has(complaint(with(good, kPartsAt, std::uint64_t(1) << 40)), "parts"));
  EXPECT_TRUE(has(complaint(with(good, kClosedAt, 2U)), "flags"));
  EXPECT_TRUE(has(complaint(with(good, kSmoothAt, 2U)), "flags"));
  EXPECT_TRUE(has(complaint(with(good, kStorageAt, 0U)), "kind 0"));
  EXPECT_TRUE(has(complaint(with(good, kStorageAt, 4U)), "kind 4"));
  for (std::size_t b = 0; b < kBlocks; ++b)
    for (const std::uint64_t size : {~std::uint64_t(0), ~std::uint64_t(0) - 62,
                                     std::uint64_t(1) << 61, std::uint64_t(1) << 32})
      EXPECT_TRUE(has(complaint(with(good, kBlockBytesAt + 8 * b, size)), "header states")) << b;
}

TEST(FieldFile, RefusesBlocksThatAFieldOfItsKindDoesNotHave) {
  for (const DistanceField& field : small_fields()) {
    const std::string good = encode_field(field);
    for (std::size_t b = 0; b < kBlocks; ++b) {
      if (value_at<std::uint64_t>(good, kBlockBytesAt + 8 * b) != 0) continue;
      std::string more = good;
      more.insert(block_at(good, b), std::string(kAlignment, '\0'));
      EXPECT_TRUE(has(complaint(with(more, kBlockBytesAt + 8 * b, std::uint64_t(4))), "has none"));
    }
  }
}

TEST(FieldFile, MemoryFollowsTheFileNotWhatItsOctreePromises) {
  // Every letter of it a leaf of one cell in a brick of its own would take hundreds of bytes.
  std::string letters;
  const std::function<void(int)> append = [&](int cells) {
    letters += '+';
    if (cells == 2) {
      letters += "\x01o";
      return;
    }
    for (int child = 0; child < 8; ++child) append(cells / 2);
  };
  append(256);
  const auto octree = field::Octree::decode(256, letters, 1000);
  ASSERT_FALSE(octree);
  EXPECT_EQ(octree.error().code, ErrorCode::kFileCorrupt);
  EXPECT_TRUE(has(octree.error().message, "more than 1000 samples"));

  const std::string good = encode_field(small_fields()[2]);
  const auto samples = value_at<std::uint64_t>(good, kBlockBytesAt + 24);
  const std::size_t at = block_at(good, 3);
  const std::uint64_t fewer = samples - 64;  // One block of 64 bytes less.
  std::string cut = good;
  cut.erase(at, 64);
  EXPECT_TRUE(has(complaint(with(cut, kBlockBytesAt + 24, fewer)), "more than"));
}

TEST(FieldFile, WantsItsBytesAligned) {
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

TEST(FieldFile, RefusesLeavesBeyondTheLast) {
  const std::string good = encode_field(small_field());
  const std::size_t table = block_at(good, 0);
  const std::size_t bricks = value_at<std::uint64_t>(good, kBlockBytesAt) / 8;
  for (std::size_t b = 0; b < bricks; ++b) {
    if (value_at<std::uint8_t>(good, table + 8 * b + 4) == 0) continue;
    for (const std::uint32_t first : {~0U, ~0U - 7, 1U << 20})
      EXPECT_TRUE(has(complaint(with(good, table + 8 * b, first)), "beyond the last"));
    break;
  }
  // A brick that had no leaves, with eight from 2^32 - 1 on.
  const std::uint64_t forged = std::uint64_t(0xFF) << 32 | 0xFFFFFFFFU;
  EXPECT_TRUE(
      has(complaint(with(good, table, forged)), "brick 0 refers to leaves beyond the last"));
}

TEST(FieldFile, RefusesATreeThatIsNone) {
  const std::string good = encode_field(small_octree());
  const std::size_t tree = block_at(good, 2);
  const auto letters = value_at<std::uint64_t>(good, kBlockBytesAt + 16);
  std::string deep = good;
  deep[tree] = '#';  // The root alone is a leaf; the rest is left over.
  EXPECT_FALSE(decode(sealed(deep)));
  deep.replace(tree, letters, std::string(letters, '+'));
  EXPECT_FALSE(decode(sealed(deep)));
  deep[tree] = 'x';
  EXPECT_FALSE(decode(sealed(deep)));
}

TEST(FieldFile, RefusesBricksOutOfOrderAndValuesThatAreNone) {
  const std::string good = encode_field(small_octree());
  const std::size_t samples = block_at(good, 3), bricks = block_at(good, 4),
                    values = block_at(good, 5);
  EXPECT_TRUE(has(complaint(with(good, bricks, std::int32_t(-1))), "brick -1"));
  EXPECT_TRUE(has(complaint(with(good, bricks, std::int32_t(1 << 30))), "brick"));
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()})
    EXPECT_TRUE(has(complaint(with(good, samples + 4, bad)), "sample 1"));
  for (const float bad : {std::numeric_limits<float>::infinity(), 1e30F, -1e30F})
    EXPECT_TRUE(has(complaint(with(good, values, bad)), "smooth value 0 is"));
  const field::FieldFrame& frame = small_octree().frame();
  const auto max_mm = float(frame.band_mm + 4.5 * frame.cell_mm);
  EXPECT_TRUE(decode(with(good, values, max_mm)));
  EXPECT_TRUE(has(complaint(with(good, values, 1.001F * max_mm)), "smooth value 0 is"));
  // Beyond the band there are no distances.
  EXPECT_TRUE(has(complaint(with(good, samples + 4, 3.0001F)), "sample 1 is 3.0001"));
  const std::string dense = encode_field(small_fields()[4]);
  EXPECT_TRUE(has(complaint(with(dense, block_at(dense, 3) + 8, -3.0001F)), "sample 2 is -3.0001"));
}

}  // namespace
}  // namespace lefort::io
