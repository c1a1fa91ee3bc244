/// \file
/// Landmarks in files: `.mrk.json` of 3D Slicer, and CSV; and the cephalometric table as CSV.
#pragma once

#include <lefort/core/error.h>
#include <lefort/plan/cephalometrics.h>
#include <lefort/plan/landmarks.h>

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lefort::io {

/// Reads landmarks; the ending says the format.
///
/// Of a `.mrk.json` all point lists ("Fiducial") are taken. A CSV has a heading, which names its
/// columns: `name` or `label`, then `x_mm,y_mm,z_mm` or `l,p,s` (L) or `r,a,s`, as Slicer exports
/// tables; further columns are ignored but for `defined`, where 0 leaves the point out. Lines that
/// start with # are passed over.
///
/// \returns the landmarks in the file's order, or
///   - kFileNotFound     there is no such file;
///   - kFileUnsupported  neither `.mrk.json` nor `.csv`, or lengths in an unknown unit;
///   - kFileCorrupt      not of its format, no landmark in it, one without a name, or two of one
///     name.
[[nodiscard]] Result<plan::Landmarks> read_landmarks(const std::filesystem::path& file);

/// Whether landmarks could be of a file.
///
/// \returns them; or kFileCorrupt for none, a name that is empty, stands twice or has control
///   characters, or a point beyond 100 m.
[[nodiscard]] Result<plan::Landmarks> checked_landmarks(plan::Landmarks landmarks);

/// A CSV's text; messages then name no file.
[[nodiscard]] Result<plan::Landmarks> parse_landmark_table(std::string_view text);

/// Writes landmarks, whole or not at all; formats as for read_landmarks(). Read back they are the
/// same bits.
///
/// \returns nothing, kFileUnsupported (the ending), or kFileUnwritable.
[[nodiscard]] Result<void> write_landmarks(const std::filesystem::path& file,
                                           std::span<const plan::Landmark> landmarks);

/// Nothing, or kFileUnsupported: whether write_landmarks() knows the ending, before any work.
[[nodiscard]] Result<void> check_landmarks_ending(const std::filesystem::path& file);

/// The table as CSV: `measurement,meaning,unit,before`, and if there is `after`, `after,change`.
/// What is not known is empty.
///
/// \param after  empty, or the lines of `before` again.
[[nodiscard]] std::string cephalometric_csv(std::span<const plan::Measurement> before,
                                            std::span<const plan::Measurement> after = {});

}  // namespace lefort::io
