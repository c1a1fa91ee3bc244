/// \file
/// Separates the lips of a closed mouth in the tissue mesh.
#pragma once

#include <lefort/core/types.h>
#include <lefort/mesh/volume_mesh.h>
#include <lefort/predict/oral_fissure.h>
#include <lefort/predict/tissue_domain.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace lefort::predict {

namespace sets {
/// Nodes and faces where the lips touch in the reference configuration; these sets are missing if
/// the lips are not separated.
inline constexpr const char* kUpperLip = "upper_lip";
inline constexpr const char* kLowerLip = "lower_lip";
}  // namespace sets

/// Two nodes of the lips at the same position in the reference configuration.
struct LipPair {
  std::int32_t upper = 0, lower = 0;
  double area_mm2 = 0.0;          ///< > 0.
  Vec3 normal_L = Vec3::UnitZ();  ///< Unit length, from the lower lip to the upper one.
};

/// The separated lips, or the reason why they are not separated.
struct LipSlit {
  std::string reason;                  ///< Empty if the lips are separated.
  std::optional<OralFissure> fissure;  ///< If one was found.
  std::vector<LipPair> pairs;  ///< Ascending by `upper`; empty if the lips are not separated.
  double area_mm2 = 0.0;       ///< Of one lip.
  /// Of the nodes of the slit from the surface in which the lips touch.
  double rms_distance_mm = 0.0;

  [[nodiscard]] bool is_separated() const { return !pairs.empty(); }
};

/// A mesh and its lips.
struct TissueWithLips {
  mesh::VolumeMesh tissue;  ///< With the sets kUpperLip and kLowerLip if the lips are separated.
  LipSlit lips;
};

/// Opens a slit along the surface in which the lips touch (mesh/open_slit.h). Elements keep their
/// numbers.
///
/// \param tissue  mesh of the domain, without sets.
/// \param domain  boundary nodes that move stay on the zero surface of its level.
/// \param search  the fissure, or why there is none.
[[nodiscard]] TissueWithLips separate_lips(mesh::VolumeMesh tissue, const TissueDomain& domain,
                                           FissureSearch search);

/// One line for the log.
[[nodiscard]] std::string describe(const LipSlit& lips);

}  // namespace lefort::predict
