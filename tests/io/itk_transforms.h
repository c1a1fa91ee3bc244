/// \file
/// ITK's own reader and writer of transforms, for tests. ITK brings an Eigen of its own, which does
/// not go together with ours in one file.
#pragma once

#include <array>
#include <string>

namespace lefort::test {

using ItkPoint = std::array<double, 3>;

/// Where the one transform of a file, as ITK reads and applies it, takes a point.
/// \pre ITK can read it; else ITK throws.
[[nodiscard]] ItkPoint apply_itk_transform(const std::string& file, const ItkPoint& point);

/// How a rigid transform is stored.
enum class ItkKind { kVersor, kAffine };

/// Writes a rotation about an axis and a center, then a translation, as ITK does.
void write_itk_transform(const std::string& file, ItkKind kind, const ItkPoint& axis,
                         double angle_rad, const ItkPoint& center, const ItkPoint& translation);

}  // namespace lefort::test
