/// \file
/// How much the predicted face depends on the interface of tissue and bone.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/pipeline/cache/stage_cache.h>
#include <lefort/pipeline/prepare/prepare_case.h>
#include <lefort/report/case_report.h>

#include <nlohmann/json.hpp>

#include <optional>
#include <string>
#include <vector>

namespace lefort::pipeline {

/// Distance between the faces predicted with the interfaces `bonded` and `contact`, at the end of
/// the path, on the same coarse mesh, over the skin that moves by more than 0.5 mm with either
/// interface. If the solve with `bonded` fails, for example because elements between two bonded
/// bones invert, the interface `clinical` replaces `bonded`.
struct InterfaceSensitivity {
  double element_size_mm = 0.0;                                           ///< Of the coarse mesh.
  predict::TissueInterface attached = predict::TissueInterface::kBonded;  ///< Or kClinical.
  double p50_mm = 0.0, p90_mm = 0.0, p99_mm = 0.0, max_mm = 0.0;          ///< Of the distance.
  std::optional<std::string> failure = std::nullopt;  ///< Why there are no distances.
  /// Displacement of each vertex of the skin with the interface `attached`, and with `contact`
  /// [mm]; empty with `failure`.
  std::vector<Vec3> attached_mm{}, contact_mm{};
};

/// \param prepared  the case; its own interface is not used.
/// \param cache     of the coarse mesh.
/// \returns the distances, or `failure` if a solve fails; or kCancelled.
[[nodiscard]] Result<InterfaceSensitivity> measure_interface_sensitivity(
    const PreparedCase& prepared, const StageCache& cache, Progress& progress);

[[nodiscard]] nlohmann::ordered_json as_json(const InterfaceSensitivity& sensitivity);

/// For the report.
[[nodiscard]] report::ReportTable as_table(const InterfaceSensitivity& sensitivity);

/// "P50 1.3 mm, P90 3.2 mm, P99 6.5 mm", or why it is unknown.
[[nodiscard]] std::string in_words(const InterfaceSensitivity& sensitivity);

}  // namespace lefort::pipeline
