/// \file
/// Checks that the volumes of the parts of a cut bone add up. Used in this layer only.
#pragma once

#include <lefort/core/error.h>

#include <string>
#include <vector>

namespace lefort::plan {

/// The tolerance is the lesser of 0.1 % of the whole and 1 % of the smallest part that is not
/// empty, so that no part can vanish unnoticed.
///
/// \param cut        for the message: "osteotomy of 'chin'".
/// \param whole_mm3  volume before the cut.
/// \param parts_mm3  volumes of the parts.
/// \returns nothing, or kMeshingFailed if the sum differs from the whole.
[[nodiscard]] Result<void> check_volumes(const std::string& cut, double whole_mm3,
                                         const std::vector<double>& parts_mm3);

}  // namespace lefort::plan
