#include <lefort/io/field_file.h>

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "io/field_bytes.h"
#include "support/text.h"

namespace lefort::io::test_field_file_damage {
namespace {

using field::DistanceField;
using test::block_at;
using test::contains;
using test::decode_copy;
using test::kAlignment;
using test::kBandAt;
using test::kBlockBytesAt;
using test::kBlocks;
using test::kCellAt;
using test::kChecksumAt;
using test::kClosedAt;
using test::kHeaderBytes;
using test::kOriginAt;
using test::kPartsAt;
using test::kResolutionAt;
using test::kSmoothAt;
using test::kStorageAt;
using test::kToleranceAt;
using test::kTrianglesAt;
using test::small_field;
using test::small_fields;
using test::small_octree;
using test::value_at;
using test::with_checksum;
using test::with_value;

TEST(FieldFile, RejectsEveryTruncation) {
  for (const DistanceField& field : small_fields()) {
    const std::string whole = encode_field(field);
    // Every length of the header, and many of the rest.
    for (std::size_t size = 0; size < whole.size();
         size += size < 2 * kHeaderBytes ? 1 : 1 + whole.size() / 500) {
      const auto cut = decode_copy(std::string_view(whole).substr(0, size));
      ASSERT_FALSE(cut) << size;
      EXPECT_EQ(cut.error().code, size < 8 ? ErrorCode::kFileUnsupported : ErrorCode::kFileCorrupt);
      // Also with a valid checksum.
      if (size < kHeaderBytes) continue;
      EXPECT_FALSE(decode_copy(with_checksum(whole.substr(0, size)))) << size;
    }
    EXPECT_FALSE(decode_copy(whole + '\0'));
    EXPECT_FALSE(decode_copy(with_checksum(whole + std::string(64, '\0'))));
  }
}

TEST(FieldFile, RejectsEveryFlippedBit) {
  for (const DistanceField& field : small_fields()) {
    std::string bytes = encode_field(field);
    std::mt19937 random(2);
    for (int n = 0; n < 500; ++n) {
      // Half of them are in the header.
      const std::size_t at = random() % (n % 2 == 0 ? kHeaderBytes : bytes.size());
      const char flip = char(1 << (random() % 8));
      bytes[at] = char(bytes[at] ^ flip);
      EXPECT_FALSE(decode_copy(bytes)) << "byte " << at;
      bytes[at] = char(bytes[at] ^ flip);
    }
    EXPECT_TRUE(decode_copy(bytes));
  }
}

/// Calls every query of a field; results may be wrong but must be valid numbers.
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

TEST(FieldFile, SurvivesForgedFilesWithAValidChecksum) {
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
      const auto read = decode_copy(with_checksum(forged));
      if (!read) {
        EXPECT_EQ(read.error().code, ErrorCode::kFileCorrupt);
        continue;
      }
      ++accepted;
      query(*read, random);  // Most are rejected; the others must be harmless.
      ASSERT_FALSE(HasFatalFailure()) << "file " << n << " of storage " << field.samples().index();
    }
  }
  EXPECT_GT(accepted, 100);
}

TEST(FieldFile, SurvivesBlocksSwappedAndShortened) {
  // Blocks of different files with consistent sizes.
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
    const auto read = decode_copy(with_checksum(header + rest));
    if (!read) continue;
    query(*read, random);
    ASSERT_FALSE(HasFatalFailure()) << n;
  }
}

std::string decode_error(const std::string& bytes) {
  const auto read = decode_copy(bytes);
  if (read) return "accepted";
  EXPECT_EQ(read.error().code, ErrorCode::kFileCorrupt);
  return read.error().message;
}

TEST(FieldFile, ReportsTheErrorOfAForgedHeader) {
  const std::string good = encode_field(small_field());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(contains(decode_error(with_value(good, kResolutionAt, 17)), "resolution is 17"));
  EXPECT_TRUE(contains(decode_error(with_value(good, kResolutionAt, 1 << 20)), "resolution"));
  EXPECT_TRUE(contains(decode_error(with_value(good, kResolutionAt, -16)), "resolution"));
  EXPECT_TRUE(contains(decode_error(with_value(good, kResolutionAt, 8)), "table has"));
  EXPECT_TRUE(contains(decode_error(with_value(encode_field(small_octree()), kResolutionAt, 8)),
                       "octree is invalid"));
  EXPECT_TRUE(contains(decode_error(with_value(encode_field(small_fields()[4]), kResolutionAt, 8)),
                       "bytes of samples"));
  EXPECT_TRUE(contains(decode_error(with_value(good, kCellAt, nan)), "cells are nan"));
  EXPECT_TRUE(contains(decode_error(with_value(good, kCellAt, -1.0)), "cells are -1"));
  EXPECT_TRUE(contains(decode_error(with_value(good, kBandAt, 1e9)), "band"));
  EXPECT_TRUE(contains(decode_error(with_value(good, kBandAt, 0.0)), "band"));
  EXPECT_TRUE(contains(decode_error(with_value(good, kOriginAt, nan)), "origin"));
  EXPECT_TRUE(contains(decode_error(with_value(good, kOriginAt + 16, 1e300)), "origin"));
  EXPECT_TRUE(contains(decode_error(with_value(good, kToleranceAt, nan)), "tolerance"));
  EXPECT_TRUE(contains(decode_error(with_value(good, kToleranceAt, -1.0)), "tolerance"));
  for (const double absurd : {1e-300, 1e-9, 1e7, 1e300})
    EXPECT_TRUE(contains(decode_error(with_value(good, kCellAt, absurd)), "cells are")) << absurd;
  EXPECT_TRUE(
      contains(decode_error(with_value(good, kBandAt, 0.9 * small_field().cell_mm())), "band"));
  EXPECT_TRUE(
      contains(decode_error(with_value(good, kTrianglesAt, ~std::uint64_t(0))), "triangles"));
  EXPECT_TRUE(contains(decode_error(with_value(good, kPartsAt, std::uint64_t(1) << 40)), "parts"));
  EXPECT_TRUE(contains(decode_error(with_value(good, kClosedAt, 2U)), "flags"));
  EXPECT_TRUE(contains(decode_error(with_value(good, kSmoothAt, 2U)), "flags"));
  EXPECT_TRUE(contains(decode_error(with_value(good, kStorageAt, 0U)), "kind 0"));
  EXPECT_TRUE(contains(decode_error(with_value(good, kStorageAt, 4U)), "kind 4"));
  for (std::size_t b = 0; b < kBlocks; ++b)
    for (const std::uint64_t size : {~std::uint64_t(0), ~std::uint64_t(0) - 62,
                                     std::uint64_t(1) << 61, std::uint64_t(1) << 32})
      EXPECT_TRUE(
          contains(decode_error(with_value(good, kBlockBytesAt + 8 * b, size)), "header states"))
          << b;
}

TEST(FieldFile, RejectsUnexpectedBlocks) {
  for (const DistanceField& field : small_fields()) {
    const std::string good = encode_field(field);
    for (std::size_t b = 0; b < kBlocks; ++b) {
      if (value_at<std::uint64_t>(good, kBlockBytesAt + 8 * b) != 0) continue;
      std::string more = good;
      more.insert(block_at(good, b), std::string(kAlignment, '\0'));
      EXPECT_TRUE(contains(decode_error(with_value(more, kBlockBytesAt + 8 * b, std::uint64_t(4))),
                           "has none"));
    }
  }
}

TEST(FieldFile, AllocatesNoMoreThanTheFileContains) {
  // If every letter were a leaf of one cell in its own brick, each would need hundreds of bytes.
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
  EXPECT_TRUE(contains(octree.error().message, "more than 1000 samples"));

  const std::string good = encode_field(small_fields()[2]);
  const auto samples = value_at<std::uint64_t>(good, kBlockBytesAt + 24);
  const std::size_t at = block_at(good, 3);
  const std::uint64_t fewer = samples - 64;  // One block of 64 bytes less.
  std::string cut = good;
  cut.erase(at, 64);
  EXPECT_TRUE(contains(decode_error(with_value(cut, kBlockBytesAt + 24, fewer)), "more than"));
}

TEST(FieldFile, RejectsLeavesBeyondTheLast) {
  const std::string good = encode_field(small_field());
  const std::size_t table = block_at(good, 0);
  const std::size_t bricks = value_at<std::uint64_t>(good, kBlockBytesAt) / 8;
  for (std::size_t b = 0; b < bricks; ++b) {
    if (value_at<std::uint8_t>(good, table + 8 * b + 4) == 0) continue;
    for (const std::uint32_t first : {~0U, ~0U - 7, 1U << 20})
      EXPECT_TRUE(
          contains(decode_error(with_value(good, table + 8 * b, first)), "beyond the last"));
    break;
  }
  // A brick without leaves now refers to eight leaves from 2^32 - 1.
  const std::uint64_t forged = std::uint64_t(0xFF) << 32 | 0xFFFFFFFFU;
  EXPECT_TRUE(contains(decode_error(with_value(good, table, forged)),
                       "brick 0 refers to leaves beyond the last"));
}

TEST(FieldFile, RejectsInvalidOctrees) {
  const std::string good = encode_field(small_octree());
  const std::size_t tree = block_at(good, 2);
  const auto letters = value_at<std::uint64_t>(good, kBlockBytesAt + 16);
  std::string deep = good;
  deep[tree] = '#';  // The root is a leaf, so the rest is unused.
  EXPECT_FALSE(decode_copy(with_checksum(deep)));
  deep.replace(tree, letters, std::string(letters, '+'));
  EXPECT_FALSE(decode_copy(with_checksum(deep)));
  deep[tree] = 'x';
  EXPECT_FALSE(decode_copy(with_checksum(deep)));
}

TEST(FieldFile, RejectsUnorderedBricksAndInvalidValues) {
  const std::string good = encode_field(small_octree());
  const std::size_t samples = block_at(good, 3), bricks = block_at(good, 4),
                    values = block_at(good, 5);
  EXPECT_TRUE(contains(decode_error(with_value(good, bricks, std::int32_t(-1))), "brick -1"));
  EXPECT_TRUE(contains(decode_error(with_value(good, bricks, std::int32_t(1 << 30))), "brick"));
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()})
    EXPECT_TRUE(contains(decode_error(with_value(good, samples + 4, bad)), "sample 1"));
  for (const float bad : {std::numeric_limits<float>::infinity(), 1e30F, -1e30F})
    EXPECT_TRUE(contains(decode_error(with_value(good, values, bad)), "smooth value 0 is"));
  const field::FieldFrame& frame = small_octree().frame();
  const auto max_mm = float(frame.band_mm + 4.5 * frame.cell_mm);
  EXPECT_TRUE(decode_copy(with_value(good, values, max_mm)));
  EXPECT_TRUE(
      contains(decode_error(with_value(good, values, 1.001F * max_mm)), "smooth value 0 is"));
  // Beyond the band there are no distances.
  EXPECT_TRUE(contains(decode_error(with_value(good, samples + 4, 3.0001F)), "sample 1 is 3.0001"));
  const std::string dense = encode_field(small_fields()[4]);
  EXPECT_TRUE(contains(decode_error(with_value(dense, block_at(dense, 3) + 8, -3.0001F)),
                       "sample 2 is -3.0001"));
}

}  // namespace
}  // namespace lefort::io::test_field_file_damage
