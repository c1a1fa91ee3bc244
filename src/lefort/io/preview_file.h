/// \file
/// What a preview is computed from, in a file.
#pragma once

#include <lefort/core/error.h>
#include <lefort/predict/face_preview.h>

#include <filesystem>
#include <span>

namespace lefort::io {

/// \returns nothing, or kFileUnwritable.
[[nodiscard]] Result<void> write_preview_model(const std::filesystem::path& file,
                                               const predict::PreviewModel& model);

/// \returns kFileNotFound, or kFileCorrupt if the file is not as write_preview_model() left it.
/// \note Of this machine: numbers are written as they lie in memory.
[[nodiscard]] Result<predict::PreviewModel> read_preview_model(const std::filesystem::path& file);

/// How far a preview is from the full solve, where that moves the skin more than 0.5 mm.
struct PreviewDistance {
  Index moved_vertices = 0;
  double p50_mm = 0.0, p99_mm = 0.0, max_mm = 0.0;
  double max_shift_mm = 0.0;  ///< Of the full solve.
};

/// \param preview_mm     displacement of each vertex.
/// \param before_L       the skin at rest; `after_L` by the full solve. As many.
[[nodiscard]] PreviewDistance measure_preview(std::span<const Vec3> preview_mm,
                                              std::span<const Vec3> before_L,
                                              std::span<const Vec3> after_L);

}  // namespace lefort::io
