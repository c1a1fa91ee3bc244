/// \file
/// Histograms of element quality, as SVG files.
#pragma once

#include <lefort/mesh/element_quality.h>

#include <string>
#include <utility>
#include <vector>

namespace lefort::report {

/// \param quality  of a mesh.
/// \returns names and contents of the files: histograms of scaled Jacobians and of smallest
///   dihedral angles, one line per element shape.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> mesh_plots(
    const mesh::MeshQuality& quality);

}  // namespace lefort::report
