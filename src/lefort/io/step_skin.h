/// \file
/// The face at every step of a prediction that was written.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/predict/embed_skin.h>

#include <filesystem>
#include <vector>

namespace lefort::io {

/// How the skin of a prediction's folder follows its tissue.
class StepSkin {
 public:
  /// \param folder      as predict_case() left it, with prediction.json.
  /// \param spacing_mm  of the scan.
  /// \returns kFileNotFound or kFileCorrupt.
  [[nodiscard]] static Result<StepSkin> read(const std::filesystem::path& folder,
                                             const Vec3& spacing_mm);

  /// Of each vertex of skin_before.vtp [mm].
  ///
  /// \param step  from 0, which is rest.
  /// \returns kFileNotFound if there is no such step, or kFileCorrupt.
  [[nodiscard]] Result<std::vector<Vec3>> displacement_mm(int step) const;

 private:
  std::filesystem::path folder_;
  predict::SkinEmbedding binding_;
  Index nodes_ = 0;
};

}  // namespace lefort::io
