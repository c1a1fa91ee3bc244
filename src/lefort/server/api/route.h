/// \file
/// The routes of contract/openapi.json in groups, one file and one function for each group.
#pragma once

#include <lefort/server/api/message.h>

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lefort::server {

struct ServedCase;

/// Values of the parameters in a path, in order.
using PathValues = std::vector<std::string>;

struct Route {
  std::string_view method, path;  ///< As in the contract: "GET", "/jobs/{job}".
  Response (*handle)(ServedCase& served, const Request& request, const PathValues& values);
};

[[nodiscard]] std::span<const Route> case_routes();         ///< State of the case.
[[nodiscard]] std::span<const Route> job_routes();          ///< Uploads, jobs, events.
[[nodiscard]] std::span<const Route> scan_routes();         ///< Voxels and their labels.
[[nodiscard]] std::span<const Route> boundary_routes();     ///< Painted boundary conditions.
[[nodiscard]] std::span<const Route> surface_routes();      ///< Skin, skull, cut bones.
[[nodiscard]] std::span<const Route> landmark_routes();     ///< Landmarks and measurements.
[[nodiscard]] std::span<const Route> plan_routes();         ///< The plan, its path, templates.
[[nodiscard]] std::span<const Route> movement_routes();     ///< Overlap and preview while dragging.
[[nodiscard]] std::span<const Route> prediction_routes();   ///< Steps of the prediction.
[[nodiscard]] std::span<const Route> comparison_routes();   ///< Comparison; values on surfaces.
[[nodiscard]] std::span<const Route> uncertainty_routes();  ///< Band of the predicted face.
[[nodiscard]] std::span<const Route> measure_routes();      ///< Teeth, canals and other measures.
[[nodiscard]] std::span<const Route> variant_routes();      ///< Kept plans, side by side.
[[nodiscard]] std::span<const Route> file_routes();         ///< Files for download.

}  // namespace lefort::server
