/// \file
/// ITK's own reader of images, for tests. ITK brings an Eigen of its own, which does not go together
/// with ours in one file.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace lefort::test {

/// An image in space as ITK understands the file: in LPS, mm, voxels with i fastest.
struct ItkImage {
  std::array<std::size_t, 3> size;
  std::array<double, 3> spacing, origin;
  std::array<std::array<double, 3>, 3> direction;  ///< Rows.
  std::vector<double> values;
};

/// \pre ITK can read it; else ITK throws.
[[nodiscard]] ItkImage read_itk_image(const std::string& file);

}  // namespace lefort::test
