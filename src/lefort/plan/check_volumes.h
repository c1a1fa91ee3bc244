/// \file
/// Whether the parts of a cut bone are all of it. For this layer.
#pragma once

#include <lefort/core/error.h>

#include <string>
#include <vector>

namespace lefort::plan {

/// Nothing, or kMeshingFailed: whether the parts make up the whole.
///
/// They may miss it by 0.1 % of the whole and by 1 % of the smallest part that is not empty, so
/// that no part can vanish unnoticed.
///
/// \param cut  for the message: "osteotomy of 'chin'".
[[nodiscard]] Result<void> check_volumes(const std::string& cut, double whole_mm3,
                                         const std::vector<double>& parts_mm3);

}  // namespace lefort::plan
