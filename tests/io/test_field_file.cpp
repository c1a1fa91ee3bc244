#include <lefort/field/build_distance_field.h>
#include <lefort/io/field_file.h>
#include <lefort/io/write_atomically.h>

#include <gtest/gtest.h>
#include <zlib.h>

#include <cstring>
#include <limits>
#include <random>

#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace lefort::io {
namespace {

constexpr std::size_t kVersionAt = 8, kResolutionAt = 12, kCellAt = 40, kBandAt = 48;
constexpr std::size_t kClosedAt = 64, kCodeCountAt = 72, kSampleCountAt = 80, kBrickCountAt = 88;
constexpr std::size_t kHeaderBytes = 96;

const field::DistanceField& small_field() {
  static const field::DistanceField field =
      field::build_distance_field(test::make_torus(6, 2, 24, 12), {.resolution = 16}).value();
  return field;
}

/// A file whose checksum is right: what an attacker, not a failing disk, would write.
std::string sealed(std::string bytes) {
  const std::size_t body = bytes.size() - 4;
  const auto crc =
      std::uint32_t(::crc32_z(0, reinterpret_cast<const unsigned char*>(bytes.data()), body));
  std::memcpy(bytes.data() + body, &crc, sizeof(crc));
  return bytes;
}

template <class T>
std::string with(std::string bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof(value));
  return sealed(std::move(bytes));
}

TEST(FieldFile, ReadsBackWhatWasWritten) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_field(folder / "bone.field", small_field()));
  const auto read = read_field(folder / "bone.field");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(encode_field(*read), encode_field(small_field()));
  std::mt19937 random(1);
  std::uniform_real_distribution<double> in(-9, 9);
  for (int n = 0; n < 1000; ++n) {
    const Vec3 p(in(random), in(random), in(random) / 3);
    const auto a = small_field().sample_smooth(p), b = read->sample_smooth(p);
    EXPECT_EQ(a.zone, b.zone);
    EXPECT_EQ(a.distance_mm, b.distance_mm);
    EXPECT_EQ(a.hessian_B, b.hessian_B);
    EXPECT_EQ(small_field().sample(p).distance_mm, read->sample(p).distance_mm);
    EXPECT_EQ(small_field().sample(p).gradient_B, read->sample(p).gradient_B);
  }
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

TEST(FieldFile, RefusesAnotherVersion) {
  const auto newer = decode_field(with(encode_field(small_field()), kVersionAt, 2U));
  EXPECT_EQ(newer.error().code, ErrorCode::kFileUnsupported);
  EXPECT_NE(newer.error().message.find("version 2"), std::string::npos);
}

TEST(FieldFile, RefusesEveryTruncation) {
  const std::string whole = encode_field(small_field());
  for (std::size_t size = 0; size < whole.size(); size += 1 + whole.size() / 500) {
    const auto cut = decode_field(std::string_view(whole).substr(0, size));
    ASSERT_FALSE(cut) << size;
    EXPECT_EQ(cut.error().code, size < 8 ? ErrorCode::kFileUnsupported : ErrorCode::kFileCorrupt);
  }
  EXPECT_FALSE(decode_field(whole + '\0'));
}

TEST(FieldFile, RefusesEveryFlippedBit) {
  std::string bytes = encode_field(small_field());
  std::mt19937 random(2);
  for (int n = 0; n < 1000; ++n) {
    // Half of them in the header, where they do most harm.
    const std::size_t at = random() % (n % 2 == 0 ? kHeaderBytes : bytes.size());
    const char flip = char(1 << (random() % 8));
    bytes[at] = char(bytes[at] ^ flip);
    EXPECT_FALSE(decode_field(bytes)) << "byte " << at;
    bytes[at] = char(bytes[at] ^ flip);
  }
  EXPECT_TRUE(decode_field(bytes));
}

TEST(FieldFile, SurvivesForgedFilesWithARightChecksum) {
  const std::string good = encode_field(small_field());
  std::mt19937 random(3);
  std::uniform_real_distribution<double> in(-9, 9);
  for (int n = 0; n < 1000; ++n) {
    std::string forged = good;
    const auto edits = 1 + random() % 4;
    for (unsigned e = 0; e < edits; ++e)
      forged[8 + random() % ((n % 2 == 0 ? kHeaderBytes : forged.size() - 4) - 8)] =
          char(random() % 256);
    const auto read = decode_field(sealed(forged));
    if (!read) continue;  // Most are refused; the others must be harmless to query.
    for (int q = 0; q < 20; ++q) {
      const Vec3 p(in(random), in(random), in(random));
      static_cast<void>(read->sample(p));
      static_cast<void>(read->sample_smooth(p));
    }
  }
}

TEST(FieldFile, SaysWhatIsWrongWithAForgedHeader) {
  const std::string good = encode_field(small_field());
  const auto complaint = [](const std::string& bytes) {
    const auto read = decode_field(bytes);
    if (read) return std::string("accepted");
    EXPECT_EQ(read.error().code, ErrorCode::kFileCorrupt);
    return read.error().message;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto has = [](const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
  };
  EXPECT_TRUE(has(complaint(with(good, kResolutionAt, 17)), "resolution is 17"));
  EXPECT_TRUE(has(complaint(with(good, kResolutionAt, 1 << 20)), "resolution"));
  EXPECT_TRUE(has(complaint(with(good, kResolutionAt, 8)), "no tree"));
  EXPECT_TRUE(has(complaint(with(good, kCellAt, nan)), "cells are nan"));
  EXPECT_TRUE(has(complaint(with(good, kCellAt, -1.0)), "cells are -1"));
  EXPECT_TRUE(has(complaint(with(good, kBandAt, 1e9)), "band"));
  EXPECT_TRUE(has(complaint(with(good, 16, nan)), "origin"));
  EXPECT_TRUE(has(complaint(with(good, 56, nan)), "tolerance"));
  EXPECT_TRUE(has(complaint(with(good, kClosedAt, std::uint64_t(2))), "closed"));
  for (const std::size_t at : {kCodeCountAt, kSampleCountAt, kBrickCountAt})
    for (const std::uint64_t count : {std::uint64_t(0), ~std::uint64_t(0), std::uint64_t(1) << 61})
      EXPECT_TRUE(has(complaint(with(good, at, count)), "header says otherwise"));
}

TEST(FieldFile, RefusesATreeThatIsNone) {
  const std::string good = encode_field(small_field());
  std::string deep = good;
  deep[kHeaderBytes] = '#';  // The root alone is a leaf; the rest is left over.
  EXPECT_FALSE(decode_field(sealed(deep)));
  deep.replace(kHeaderBytes, small_field().octree().codes().size(),
               std::string(small_field().octree().codes().size(), '+'));
  EXPECT_FALSE(decode_field(sealed(deep)));
  deep[kHeaderBytes] = 'x';
  EXPECT_FALSE(decode_field(sealed(deep)));
}

TEST(FieldFile, RefusesBricksOutOfOrderAndValuesThatAreNone) {
  const std::string good = encode_field(small_field());
  const auto& octree = small_field().octree();
  const std::size_t samples_at = kHeaderBytes + octree.codes().size();
  const std::size_t bricks_at = samples_at + octree.samples().size() * sizeof(float);
  EXPECT_FALSE(decode_field(with(good, bricks_at, std::int32_t(-1))));
  EXPECT_FALSE(decode_field(with(good, bricks_at, std::int32_t(1 << 30))));
  EXPECT_FALSE(decode_field(with(good, samples_at, std::numeric_limits<float>::quiet_NaN())));
  EXPECT_FALSE(decode_field(with(good, good.size() - 8, std::numeric_limits<float>::infinity())));
}

}  // namespace
}  // namespace lefort::io
