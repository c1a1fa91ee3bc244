/// \file
/// A small label map with all tissues.
#pragma once

#include <lefort/anatomy/label_map.h>

#include "io/sample_scan.h"

namespace lefort::test {

inline anatomy::LabelMap sample_labels() {
  anatomy::LabelMap labels{sample_scan(oblique()).grid, {}};
  for (Index n = 0; n < labels.grid.voxel_count(); ++n)
    labels.values.push_back(static_cast<anatomy::Tissue>((n * n / 7) % 8));
  return labels;
}

}  // namespace lefort::test
