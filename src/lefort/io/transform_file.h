/// \file
/// Rigid motions in files: ITK's text transforms `.tfm` (also `.txt`), as 3D Slicer saves them.
///
/// Such a file holds the *resampling* direction, from the place a point ends at to the place it
/// comes from, in LPS: the inverse of how Slicer moves a model. It is turned round here, both ways,
/// so that a bone moves in lefort as it does in Slicer.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>

#include <filesystem>
#include <string>
#include <string_view>

namespace lefort::io {

/// Reads one transform.
///
/// The file's own center of rotation is of no use to a plan: Slicer always writes the scan's
/// origin.
///
/// \returns X_LB, or
///   - kFileNotFound     there is no such file;
///   - kFileCorrupt      not of the format, cut short, or a number is not finite;
///   - kFileUnsupported  several transforms, one of a type that is no rigid motion of space
///     (AffineTransform, MatrixOffsetTransformBase, VersorRigid3DTransform and TranslationTransform
///     are read), or a matrix that scales, shears or mirrors by more than 1e-4.
[[nodiscard]] Result<RigidTransform> read_transform(const std::filesystem::path& file);

/// The same from text; messages then name no file.
[[nodiscard]] Result<RigidTransform> parse_transform(std::string_view text);

/// Writes an AffineTransform_double_3_3 that moves a model in Slicer as `X_LB` does here, whole or
/// not at all.
///
/// \returns nothing, or kFileUnwritable.
[[nodiscard]] Result<void> write_transform(const std::filesystem::path& file,
                                           const RigidTransform& X_LB);

}  // namespace lefort::io
