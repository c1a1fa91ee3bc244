/// \file
/// Agreement of two label maps.
#pragma once

#include <lefort/anatomy/label_map.h>
#include <lefort/core/check.h>

#include <functional>

namespace lefort::test {

using Belongs = std::function<bool(anatomy::Tissue)>;

/// Whether a tissue is this tissue.
inline Belongs is(anatomy::Tissue wanted) {
  return [wanted](anatomy::Tissue tissue) { return tissue == wanted; };
}

/// Dice's coefficient: twice the intersection over the sum of both.
inline double dice(const anatomy::LabelMap& found, const anatomy::LabelMap& truth,
                   const Belongs& belongs) {
  LEFORT_CHECK(found.values.size() == truth.values.size());
  double common = 0.0, sum = 0.0;
  for (std::size_t v = 0; v < truth.values.size(); ++v) {
    const bool a = belongs(found.values[v]), b = belongs(truth.values[v]);
    common += a && b ? 1.0 : 0.0;
    sum += (a ? 1.0 : 0.0) + (b ? 1.0 : 0.0);
  }
  return 2.0 * common / sum;
}

}  // namespace lefort::test
