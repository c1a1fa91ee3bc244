/// \file
/// Why a ratio of soft tissue to bone lies outside its published range.
#pragma once

#include <lefort/compare/soft_tissue_ratios.h>

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lefort::pipeline {

/// One ratio with two interfaces of tissue and bone, on the coarse mesh of InterfaceSensitivity.
struct RatioByInterface {
  /// With InterfaceSensitivity::attached: `bonded`, or `clinical` if that fails.
  double attached = 0.0;
  double contact = 0.0;  ///< With `contact`.
};

/// A ratio with what may explain a deviation from its range.
struct ExplainedRatio {
  compare::SoftTissueRatio ratio;
  std::optional<RatioByInterface> by_interface = std::nullopt;
  /// Distance of the skin landmark from the closest point of the scan boundary [mm]; set only if it
  /// is at most kNearScanBoundary_mm.
  std::optional<double> scan_boundary_mm = std::nullopt;
};

/// Conditions at the scan boundary affect the skin up to a distance of about twice the thickness of
/// the soft tissue (Saint-Venant's principle); lips and chin are 12 to 15 mm thick (\cite
/// arnett1999).
inline constexpr double kNearScanBoundary_mm = 25.0;

/// \param ratios    of the prediction.
/// \param attached  with the interface InterfaceSensitivity::attached, for the same segments and
///   landmarks; or empty.
/// \param contact   with the interface `contact`; or empty.
/// \returns `ratios` in their order. `by_interface` is set only if both `attached` and `contact`
///   contain the same ratio.
[[nodiscard]] std::vector<ExplainedRatio> with_interfaces(
    std::span<const compare::SoftTissueRatio> ratios,
    std::span<const compare::SoftTissueRatio> attached,
    std::span<const compare::SoftTissueRatio> contact);

/// Sets ExplainedRatio::scan_boundary_mm.
///
/// \param ratios           changed.
/// \param landmarks_L      before surgery.
/// \param scan_boundary_L  nodes of the tissue at the scan boundary [mm]; may be empty.
void measure_scan_boundary(std::vector<ExplainedRatio>& ratios,
                           std::span<const plan::Landmark> landmarks_L,
                           std::span<const Vec3> scan_boundary_L);

/// \returns whether there is a published range that does not contain the ratio.
[[nodiscard]] bool deviates(const compare::SoftTissueRatio& ratio);

/// \returns sentences, one for each possible reason: the interface, the end of the scan, parts of
///   the face that the model lacks, a published mean without its spread, an axis that is not the
///   main one of the movement. Empty if the ratio does not deviate; otherwise one or more, or "No
///   reason was found."
[[nodiscard]] std::vector<std::string> deviation_reasons(const ExplainedRatio& explained);

}  // namespace lefort::pipeline
