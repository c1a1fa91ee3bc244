/// \file
/// Summary of a surface made from a scan.
#pragma once

#include <lefort/mesh/finish_surface.h>

#include <nlohmann/json.hpp>

#include <string>

namespace lefort::pipeline {

/// "164312 triangles, closed, 0 self-intersections, P99 0.12 mm off the isosurface".
[[nodiscard]] std::string text_of(const mesh::FinishedSurface& surface);
[[nodiscard]] nlohmann::json json_of(const mesh::FinishedSurface& surface);

}  // namespace lefort::pipeline
