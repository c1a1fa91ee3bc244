/// \file
/// Finds the oral fissure of a closed mouth: the line between the lips from commissure to
/// commissure, and the surface in which the lips touch. Described in docs/theory/interface.md.
#pragma once

#include <lefort/anatomy/label_map.h>
#include <lefort/core/types.h>
#include <lefort/image/volume.h>

#include <optional>
#include <string>
#include <vector>

namespace lefort::predict {

struct JawTeeth;

/// Landmarks of the lips; they override what is found.
struct LipLandmarks {
  std::optional<Vec3> stomion_L;  ///< Stm.
  std::optional<Vec3> right_L;    ///< Ch-R.
  std::optional<Vec3> left_L;     ///< Ch-L.
};

/// What determines the height of the fissure.
enum class FissureSource {
  kLandmarks,  ///< The landmark Stm, and the crease within 3 mm of it.
  kCrease,     ///< A crease of the skin.
  kJaws,       ///< Without a crease: the middle between the anterior edges of the jaws.
};

[[nodiscard]] constexpr const char* name_of(FissureSource source) {
  switch (source) {
    case FissureSource::kLandmarks:
      return "landmarks";
    case FissureSource::kCrease:
      return "crease";
    default:
      return "jaws";
  }
}

/// The surface in which the lips touch, as a height over the x and y axes of L. It starts at the
/// fissure and reaches the anterior teeth at the level of their edges.
struct OralFissure {
  /// A point of the fissure, and the anterior surface of the jaws behind it.
  struct Column {
    double skin_y_mm = 0.0, skin_z_mm = 0.0;
    double jaw_y_mm = 0.0;
    double crease_mm = 0.0;  ///< Depth of the crease.
  };
  FissureSource source = FissureSource::kJaws;
  double first_x_mm = 0.0;  ///< Of the first column; the next ones are 1 mm further to the left.
  std::vector<Column> columns;
  double right_x_mm = 0.0, left_x_mm = 0.0;  ///< Of the commissures.
  double edge_z_mm = 0.0;                    ///< Level of the edges of the anterior teeth.
  double crease_depth_mm = 0.0;              ///< Median over the middle 24 mm.
  /// Fraction of the width with a crease; 1 with the landmarks Stm, Ch-R and Ch-L; 0 with kJaws.
  double confidence = 0.0;

  [[nodiscard]] double width_mm() const { return left_x_mm - right_x_mm; }
  /// Approximate signed distance to the surface [mm], positive at the upper lip.
  [[nodiscard]] double level(const Vec3& p_L) const;
  /// Positive between the commissures and anterior to the lingual side of the teeth [mm].
  [[nodiscard]] double extent(const Vec3& p_L) const;
};

/// A fissure, or the reason why there is none.
struct FissureSearch {
  std::optional<OralFissure> fissure;
  std::string reason;  ///< Empty if there is a fissure.
};

/// Finds the fissure.
///
/// \param labels       of the scan. If find_jaw_edges() finds none, the landmark Stm is needed.
/// \param soft_tissue  level-set function of the soft tissue (anatomy/tissue_levels.h).
/// \param landmarks    in L [mm].
/// \param teeth        may be null. They determine the level of the edges and the anterior surface
///   where they are; elsewhere, bone does.
[[nodiscard]] FissureSearch find_oral_fissure(const anatomy::LabelMap& labels,
                                              const image::ScalarVolume& soft_tissue,
                                              const LipLandmarks& landmarks,
                                              const JawTeeth* teeth = nullptr);

}  // namespace lefort::predict
