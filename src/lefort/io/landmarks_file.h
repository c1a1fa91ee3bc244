/// \file
/// Landmark files: `.mrk.json` of 3D Slicer and CSV; the cephalometric table as CSV.
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

/// Reads landmarks in the format of the ending.
///
/// All point lists ("Fiducial") of a `.mrk.json` are read. The first line of a CSV names its
/// columns: `name` or `label`, and `x_mm,y_mm,z_mm` or `l,p,s` (frame L) or `r,a,s`, as in tables
/// exported by Slicer. A point with 0 in the column `defined` is omitted; further columns are
/// ignored, and so are lines that start with #.
///
/// \param file  ends in `.mrk.json` or `.csv`.
/// \returns the landmarks in the order of the file, or
///   - kFileNotFound     the file does not exist;
///   - kFileUnsupported  another ending, or lengths in an unknown unit;
///   - kFileCorrupt      not of its format, or landmarks that checked_landmarks() rejects.
[[nodiscard]] Result<plan::Landmarks> read_landmarks(const std::filesystem::path& file);

/// Checks names and coordinates of landmarks.
///
/// \param landmarks  to check.
/// \returns the landmarks; or kFileCorrupt if there is none, a name is empty, repeated or has
///   control characters, or a coordinate is beyond +-100 m.
[[nodiscard]] Result<plan::Landmarks> checked_landmarks(plan::Landmarks landmarks);

/// Reads landmarks from the text of a CSV.
///
/// \param text  of the whole file.
/// \returns as read_landmarks(), with messages without a file name.
[[nodiscard]] Result<plan::Landmarks> parse_landmark_table(std::string_view text);

/// Writes landmarks atomically in the formats of read_landmarks(). Reading the file returns the
/// same bits.
///
/// \param file       ends in `.mrk.json` or `.csv`.
/// \param landmarks  to write.
/// \param remarks    one for each landmark, added to its meaning; or none.
/// \returns nothing, kFileUnsupported (the ending), or kFileUnwritable.
[[nodiscard]] Result<void> write_landmarks(const std::filesystem::path& file,
                                           std::span<const plan::Landmark> landmarks,
                                           std::span<const std::string> remarks = {});

/// Checks the ending of a file for write_landmarks() before the landmarks are computed.
///
/// \param file  need not exist.
/// \returns nothing, or kFileUnsupported.
[[nodiscard]] Result<void> check_landmarks_ending(const std::filesystem::path& file);

/// Returns the cephalometric table as CSV: `measurement,meaning,unit,before` and, unless `after` is
/// empty, `after,change`. Unknown values are empty fields.
///
/// \param before  the measurements before surgery.
/// \param after   empty, or the same measurements after surgery.
[[nodiscard]] std::string cephalometric_csv(std::span<const plan::Measurement> before,
                                            std::span<const plan::Measurement> after = {});

}  // namespace lefort::io
