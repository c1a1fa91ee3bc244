/// \file
/// The file of a preview model.
#pragma once

#include <lefort/core/error.h>
#include <lefort/predict/face_preview.h>

#include <filesystem>
#include <span>

namespace lefort::io {

/// \param file   to write.
/// \param model  of the preview.
/// \returns nothing, or kFileUnwritable.
[[nodiscard]] Result<void> write_preview_model(const std::filesystem::path& file,
                                               const predict::PreviewModel& model);

/// \param file  of write_preview_model().
/// \returns the model, kFileNotFound, or kFileCorrupt if the file is truncated or inconsistent.
/// \note The file is not portable: numbers have the byte order of the machine that wrote it.
[[nodiscard]] Result<predict::PreviewModel> read_preview_model(const std::filesystem::path& file);

/// Differences between a preview and the full solution, at vertices that the full solution moves by
/// more than 0.5 mm.
struct PreviewDistance {
  Index moved_vertices = 0;
  double p50_mm = 0.0, p99_mm = 0.0, max_mm = 0.0;
  double max_shift_mm = 0.0;  ///< Of the full solution.
};

/// Compares a preview with the full solution.
///
/// \param preview_mm  displacement of each vertex in the preview.
/// \param before_L    vertices of the skin before surgery, as many as in `preview_mm`.
/// \param after_L     the same vertices in the full solution.
[[nodiscard]] PreviewDistance measure_preview(std::span<const Vec3> preview_mm,
                                              std::span<const Vec3> before_L,
                                              std::span<const Vec3> after_L);

}  // namespace lefort::io
