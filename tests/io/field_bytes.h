/// \file
/// The bytes of distance field files (docs/reference/field-format.md), for tests.
#pragma once

#include <lefort/field/build/build_distance_field.h>
#include <lefort/io/field_file.h>

#include <zlib.h>

#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "support/shapes.h"

namespace lefort::test {

// Offsets in the header (docs/reference/field-format.md).
inline constexpr std::size_t kVersionAt = 8, kChecksumAt = 12, kStorageAt = 16, kResolutionAt = 20;
inline constexpr std::size_t kOriginAt = 24, kCellAt = 48, kBandAt = 56, kToleranceAt = 64;
inline constexpr std::size_t kClosedAt = 72, kSmoothAt = 76, kBlockBytesAt = 80, kFindingsAt = 128;
inline constexpr std::size_t kTrianglesAt = 160, kPartsAt = 168;
inline constexpr std::size_t kHeaderBytes = 192, kAlignment = 64, kBlocks = 6;

inline constexpr field::FieldMethod kFieldMethods[] = {
    field::FieldMethod::kBricks, field::FieldMethod::kHybrid, field::FieldMethod::kUniform};

/// Fields with each kind of storage, with and without a smooth lattice.
inline const std::vector<field::DistanceField>& small_fields() {
  static const std::vector<field::DistanceField> fields = [] {
    std::vector<field::DistanceField> all;
    for (const field::FieldMethod method : kFieldMethods)
      for (const bool smooth : {false, true})
        all.push_back(field::build_distance_field(
                          make_torus(6, 2, 24, 12),
                          {.method = method, .resolution = 16, .band_mm = 3.0, .smooth = smooth})
                          .value());
    return all;
  }();
  return fields;
}

/// Bricks and a smooth lattice.
inline const field::DistanceField& small_field() { return small_fields()[1]; }
inline const field::DistanceField& small_octree() { return small_fields()[3]; }

/// Decodes a copy of `bytes` with the alignment that decode_field() requires.
inline Result<field::DistanceField> decode_copy(std::string_view bytes) {
  const auto words = std::make_shared<std::vector<std::uint64_t>>((bytes.size() + 7) / 8 + 1);
  std::memcpy(words->data(), bytes.data(), bytes.size());
  return io::decode_field(std::as_bytes(std::span(*words)).first(bytes.size()), words);
}

/// Sets the checksum of a changed file, as an attacker would, to test the other checks.
inline std::string with_checksum(std::string bytes) {
  std::memset(bytes.data() + kChecksumAt, 0, 4);
  const auto crc = std::uint32_t(
      ::crc32_z(0, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
  std::memcpy(bytes.data() + kChecksumAt, &crc, sizeof(crc));
  return bytes;
}

/// Replaces the bytes at `at` by those of `value`.
template <class T>
std::string with_value(std::string bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof(value));
  return with_checksum(std::move(bytes));
}

template <class T>
T value_at(const std::string& bytes, std::size_t at) {
  T value{};
  std::memcpy(&value, bytes.data() + at, sizeof(value));
  return value;
}

/// Returns the offset of a block.
inline std::size_t block_at(const std::string& bytes, std::size_t block) {
  std::size_t begin = kHeaderBytes;
  for (std::size_t b = 0; b < block; ++b)
    begin += (value_at<std::uint64_t>(bytes, kBlockBytesAt + 8 * b) + kAlignment - 1) / kAlignment *
             kAlignment;
  return begin;
}

}  // namespace lefort::test
