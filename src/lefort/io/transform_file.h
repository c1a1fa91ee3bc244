/// \file
/// Rigid motions in ITK's text transforms `.tfm` (also `.txt`), as saved by 3D Slicer.
///
/// Such a file contains the *resampling* direction in LPS, from the final to the initial position
/// of a point: the inverse of the motion of a model in Slicer. Reading and writing invert the
/// transform, so that a bone moves in lefort as in Slicer.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>

#include <filesystem>
#include <string>
#include <string_view>

namespace lefort::io {

/// Reads one transform.
///
/// The result includes the effect of the center of rotation in the file. The center is not
/// returned, since Slicer always writes the origin of L.
///
/// \param file  the transform.
/// \returns X_LB, or
///   - kFileNotFound     the file does not exist;
///   - kFileCorrupt      not of the format, truncated, or a number is not finite;
///   - kFileUnsupported  several transforms, another type than AffineTransform,
///                       MatrixOffsetTransformBase, VersorRigid3DTransform and
///                       TranslationTransform; a matrix R with a negative determinant or an
///                       entry of R^T R - I above 1e-4; or a coordinate of the translation or the
///                       center beyond 100 m.
[[nodiscard]] Result<RigidTransform> read_transform(const std::filesystem::path& file);

/// As above from text; messages contain no file name.
[[nodiscard]] Result<RigidTransform> parse_transform(std::string_view text);

/// Writes atomically an AffineTransform_double_3_3 that moves a model in Slicer by `X_LB`.
///
/// \param file  to write.
/// \param X_LB  the rigid motion.
/// \returns nothing, or kFileUnwritable.
[[nodiscard]] Result<void> write_transform(const std::filesystem::path& file,
                                           const RigidTransform& X_LB);

}  // namespace lefort::io
