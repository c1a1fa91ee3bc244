/// \file
/// Histograms of how well shaped a mesh's elements are, as SVG files.
#pragma once

#include <lefort/mesh/element_quality.h>

#include <string>
#include <utility>
#include <vector>

namespace lefort::report {

/// File names and files: scaled Jacobians and smallest dihedral angles, one outline per shape.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> mesh_plots(
    const mesh::MeshQuality& quality);

}  // namespace lefort::report
