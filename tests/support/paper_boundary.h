/// \file
/// Boundary conditions of the paper: a segment only pushes tissue, without friction; tissue is
/// fixed where the region was cut out, and free where the scan ends.
#pragma once

#include <lefort/predict/predict_face.h>
#include <lefort/predict/prediction_options.h>

#include <optional>

namespace lefort::test {

/// \param elevation_margin_mm  if empty, the default.
[[nodiscard]] inline predict::BoundaryOptions paper_boundary(
    std::optional<double> elevation_margin_mm = std::nullopt) {
  return {.interface = predict::TissueInterface::kContact,
          .scan_boundary = predict::OuterBoundary::kFree,
          .cut_boundary = predict::OuterBoundary::kFixed,
          .elevation_margin_mm = elevation_margin_mm};
}

/// As paper_boundary(), but tissue on a segment moves with it.
[[nodiscard]] inline predict::BoundaryOptions bonded_boundary(
    std::optional<double> elevation_margin_mm = std::nullopt) {
  predict::BoundaryOptions boundary = paper_boundary(elevation_margin_mm);
  boundary.interface = predict::TissueInterface::kBonded;
  return boundary;
}

/// Defaults of a prediction, with paper_boundary().
[[nodiscard]] inline predict::PredictionOptions paper_options() {
  predict::PredictionOptions options;
  options.boundary = paper_boundary();
  options.contact.obstacle = predict::Obstacle::kBone;
  options.contact.penetration_tolerance_mm = std::nullopt;  // The penalty alone.
  return options;
}

}  // namespace lefort::test
