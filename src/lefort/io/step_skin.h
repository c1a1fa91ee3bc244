/// \file
/// The skin at each step of a prediction on disk.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/predict/embed_skin.h>

#include <filesystem>
#include <vector>

namespace lefort::io {

/// Displacements of the skin in the output folder of a prediction.
class StepSkin {
 public:
  /// \param folder      output of predict_case(), with prediction.json.
  /// \param spacing_mm  of the scan.
  /// \returns the object, kFileCorrupt if prediction.json is damaged, or the errors of read_text(),
  ///   read_surface() and read_vtu().
  [[nodiscard]] static Result<StepSkin> read(const std::filesystem::path& folder,
                                             const Vec3& spacing_mm);

  /// Returns the displacement of each vertex of skin_before.vtp [mm].
  ///
  /// \param step  from 0, the state before surgery.
  /// \returns one vector per vertex, kFileNotFound if there is no such step, or kFileCorrupt.
  [[nodiscard]] Result<std::vector<Vec3>> displacement_mm(int step) const;

 private:
  std::filesystem::path folder_;
  predict::SkinEmbedding binding_;
  Index nodes_ = 0;
};

}  // namespace lefort::io
