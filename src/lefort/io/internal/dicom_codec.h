/// \file
/// Compressed DICOM pixels. The one place that knows GDCM.
#pragma once

#include <lefort/core/error.h>

#include <cstddef>
#include <filesystem>
#include <vector>

namespace lefort::io {

/// Decodes the pixels of a file with one frame and one value per pixel.
///
/// GDCM runs in a process of its own: damaged streams make its codecs abort, print and write where
/// they should not, and none of that must reach the user's session.
///
/// \param pixels  how many there should be.
/// \returns the stored values row by row, or kFileCorrupt or kFileUnsupported with a message that
///   does not name the file.
[[nodiscard]] Result<std::vector<double>> decode_dicom_pixels(const std::filesystem::path& file,
                                                              std::size_t pixels);

}  // namespace lefort::io
