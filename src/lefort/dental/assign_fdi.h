/// \file
/// FDI numbers of the parts of a dental arch.
#pragma once

#include <lefort/anatomy/find_teeth.h>

#include <span>
#include <vector>

namespace lefort::dental {

/// A crown along the dental arch. Lengths along the curve, 0 in the mid-sagittal plane, positive to
/// the patient's left.
struct ArchPart {
  double center_mm = 0.0;
  double width_mm = 0.0;

  [[nodiscard]] double first_mm() const { return center_mm - 0.5 * width_mm; }
  [[nodiscard]] double last_mm() const { return center_mm + 0.5 * width_mm; }
};

/// See number_teeth().
///
/// \param parts  from right to left.
/// \param jaw    kUpper or kLower.
/// \returns the FDI number of each part; 0 for a part that is no tooth.
[[nodiscard]] std::vector<int> assign_fdi(std::span<const ArchPart> parts, anatomy::Tooth jaw);

}  // namespace lefort::dental
