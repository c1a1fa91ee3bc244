/// \file
/// Reading images with ITK, for tests. ITK contains its own Eigen, which conflicts with the
/// system's in one source file.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace lefort::test {

/// An image as read by ITK: in LPS, mm, voxels with i fastest.
struct ItkImage {
  std::array<std::size_t, 3> size;
  std::array<double, 3> spacing, origin;
  std::array<std::array<double, 3>, 3> direction;  ///< Rows.
  std::vector<double> values;
};

/// \pre ITK can read the file; otherwise ITK throws.
[[nodiscard]] ItkImage read_itk_image(const std::string& file);

}  // namespace lefort::test
