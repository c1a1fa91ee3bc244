/// \file
/// The routes of contract/openapi.json: by what they serve, one file a group, and one function that
/// tells the group's table.
#pragma once

#include <lefort/server/api/message.h>

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lefort::server {

struct ServedCase;

/// Values of a path's parameters, in their order.
using PathValues = std::vector<std::string>;

struct Route {
  std::string_view method, path;  ///< As in the contract: "GET", "/jobs/{job}".
  Response (*handle)(ServedCase& served, const Request& request, const PathValues& values);
};

[[nodiscard]] std::span<const Route> case_routes();        ///< What there is, and how it stands.
[[nodiscard]] std::span<const Route> job_routes();         ///< Uploads, jobs, events.
[[nodiscard]] std::span<const Route> scan_routes();        ///< Voxels and their labels.
[[nodiscard]] std::span<const Route> boundary_routes();    ///< What is painted on the tissue.
[[nodiscard]] std::span<const Route> surface_routes();     ///< Skin, skull, bones as cut.
[[nodiscard]] std::span<const Route> landmark_routes();    ///< Landmarks and what they measure.
[[nodiscard]] std::span<const Route> plan_routes();        ///< The plan, its path, templates.
[[nodiscard]] std::span<const Route> movement_routes();    ///< Overlap and preview while dragging.
[[nodiscard]] std::span<const Route> prediction_routes();  ///< What was solved, step by step.
[[nodiscard]] std::span<const Route> comparison_routes();  ///< The face after surgery.
[[nodiscard]] std::span<const Route> file_routes();        ///< Files to be taken home.

}  // namespace lefort::server
