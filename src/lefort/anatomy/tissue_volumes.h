/// \file
/// Volumes of the tissues in a scan.
#pragma once

#include <lefort/anatomy/label_map.h>

#include <string>
#include <utility>
#include <vector>

namespace lefort::anatomy {

/// Name and volume [ml] of each tissue except the background, in the order of kTissueStyles.
[[nodiscard]] std::vector<std::pair<std::string, double>> tissue_volumes_ml(const LabelMap& labels);

}  // namespace lefort::anatomy
