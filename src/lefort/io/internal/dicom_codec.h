/// \file
/// Decoding of compressed DICOM pixels. No other file uses GDCM.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <vector>

namespace lefort::io {

/// Limits of decoding one slice; the slowest codecs need one second.
struct CodecLimits {
  std::chrono::milliseconds time{30'000};           ///< Wall-clock time and processor time.
  std::size_t memory_bytes = std::size_t{1} << 30;  ///< In addition to that of this process.
};

/// Decodes the pixels of a file with one frame and one value per pixel.
///
/// GDCM runs in a child process, since damaged streams make its codecs abort, print and write to
/// invalid memory. A few wrong bytes can also cause minutes of computation or fill the memory,
/// hence the limits.
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
                                                              const CodecLimits& limits = {});

}  // namespace lefort::io
