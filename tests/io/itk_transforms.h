/// \file
/// Reading and writing transforms with ITK, for tests. ITK contains its own Eigen, which conflicts
/// with the system's in one source file.
#pragma once

#include <array>
#include <string>

namespace lefort::test {

using ItkPoint = std::array<double, 3>;

/// Applies the transform of a file to a point with ITK.
/// \pre ITK can read the file; otherwise ITK throws.
[[nodiscard]] ItkPoint apply_itk_transform(const std::string& file, const ItkPoint& point);

/// Storage of a rigid transform.
enum class ItkKind { kVersor, kAffine };

/// Writes a rotation about an axis and a center, followed by a translation, with ITK.
void write_itk_transform(const std::string& file, ItkKind kind, const ItkPoint& axis,
                         double angle_rad, const ItkPoint& center, const ItkPoint& translation);

}  // namespace lefort::test
