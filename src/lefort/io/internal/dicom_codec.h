/// \file
/// Compressed DICOM pixels. The one place that knows GDCM.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <vector>

namespace lefort::io {

/// What decoding one slice may take; the slowest codecs need a second.
struct CodecLimits {
  std::chrono::milliseconds time{30'000};           ///< On the clock and of the processor.
  std::size_t memory_bytes = std::size_t{1} << 30;  ///< Beyond what this process has already.
};

/// Decodes the pixels of a file with one frame and one value per pixel.
///
/// GDCM runs in a process of its own: damaged streams make its codecs abort, print and write where
/// they should not, and none of that must reach the user's session. A few false bytes also make
/// them compute for minutes or fill the memory, hence the limits.
///
/// \param pixels  how many there should be.
/// \returns the stored values row by row, or kFileCorrupt or kFileUnsupported with a message that
///   does not name the file, or kCancelled.
[[nodiscard]] Result<std::vector<double>> decode_dicom_pixels(const std::filesystem::path& file,
                                                              std::size_t pixels,
                                                              Progress& progress = Progress::none(),
                                                              const CodecLimits& limits = {});

}  // namespace lefort::io
