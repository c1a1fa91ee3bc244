/// \file
/// A small scan without symmetry, and comparisons with what was read.
#pragma once

#include <lefort/core/error.h>
#include <lefort/image/interpolate.h>
#include <lefort/image/volume.h>
#include <lefort/io/read_text.h>
#include <lefort/io/write_atomically.h>

#include <gtest/gtest.h>

#include <cctype>
#include <filesystem>
#include <string>
#include <vector>

namespace lefort::test {

/// Odd sizes, three spacings, HU from -1000 to 2000, all voxels different.
inline image::CtVolume sample_scan(const Mat3& direction = Mat3::Identity()) {
  image::CtVolume ct;
  ct.grid = {.size = {7, 5, 6},
             .spacing_mm = {0.4, 0.5, 1.25},
             .origin_L = {-80.5, -31.25, 12.0},
             .direction = direction};
  for (std::int16_t n = 0; n < 7 * 5 * 6; ++n)
    ct.values.push_back(static_cast<std::int16_t>(-1000 + 14 * n));
  return ct;
}

inline Mat3 oblique() {
  return Eigen::AngleAxisd(0.6, Vec3(1.0, 2.0, -0.5).normalized()).toRotationMatrix();
}

/// Expects equal values at equal positions in the patient, in any memory order.
inline void expect_same_in_patient(const image::CtVolume& found, const image::CtVolume& wanted) {
  ASSERT_EQ(found.values.size(), wanted.values.size());
  ASSERT_EQ(std::ssize(found.values), found.grid.voxel_count());
  EXPECT_NEAR(found.grid.direction.determinant(), 1.0, 1e-6);
  for (Index k = 0; k < wanted.grid.size[2]; ++k)
    for (Index j = 0; j < wanted.grid.size[1]; ++j)
      for (Index i = 0; i < wanted.grid.size[0]; ++i) {
        const Vec3 p_L = wanted.grid.point_L(
            {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
        // Neighbors differ by at least 14 HU, which detects a shift of 0.1 voxel.
        ASSERT_NEAR(image::interpolate(found, p_L, -9999.0), wanted.at(i, j, k), 0.2)
            << i << ' ' << j << ' ' << k;
      }
}

inline void expect_same_grid(const image::Grid& found, const image::Grid& wanted,
                             double tolerance) {
  EXPECT_EQ(found.size, wanted.size);
  EXPECT_LE((found.spacing_mm - wanted.spacing_mm).norm(), tolerance);
  EXPECT_LE((found.origin_L - wanted.origin_L).norm(), tolerance * 100.0);
  EXPECT_LE((found.direction - wanted.direction).norm(), tolerance);
}

/// Expects a valid error message: one line without full stop, not too long.
inline void expect_one_sentence(const std::string& message) {
  EXPECT_FALSE(message.empty());
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  EXPECT_NE(message.back(), '.') << message;
  EXPECT_LT(message.size(), 600U) << message;
}

inline std::string bytes_of(const std::filesystem::path& file) {
  return io::read_text(file, 1U << 30).value();
}

inline void write_bytes(const std::filesystem::path& file, std::string_view bytes) {
  ASSERT_TRUE(io::write_text(file, bytes));
}

}  // namespace lefort::test
