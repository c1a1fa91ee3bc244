/// \file
/// Decoding of compressed DICOM pixels. No other file uses GDCM.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/io/internal/reader_sandbox.h>

#include <cstddef>
#include <filesystem>
#include <vector>

namespace lefort::io {

/// Decodes the pixels of a file with one frame and one value per pixel.
///
/// GDCM runs in a child process (run_in_child.h), since damaged streams make its codecs abort,
/// print and write to invalid memory. A few wrong bytes can also cause minutes of computation or
/// fill the memory, hence the limits; the slowest codecs need one second per slice.
///
/// \param file      a DICOM file.
/// \param pixels    expected number.
/// \param progress  requests to stop.
/// \param limits    of time and memory.
/// \returns the stored values row by row, kFileCorrupt or kFileUnsupported with a message that does
///   not contain the file name, or kCancelled.
[[nodiscard]] Result<std::vector<double>> decode_dicom_pixels(const std::filesystem::path& file,
                                                              std::size_t pixels,
                                                              Progress& progress = Progress::none(),
                                                              const ReaderLimits& limits = {});

}  // namespace lefort::io
