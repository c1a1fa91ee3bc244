/// \file
/// Volumes as Python objects.
#pragma once

#include <lefort/anatomy/label_map.h>
#include <lefort/image/volume.h>

#include <pybind11/pybind11.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace lefort::python {

/// A volume that Python owns. Its values do not change, unless Python made it to fill it.
template <class Value>
struct OwnedVolume {
  std::shared_ptr<image::Volume<Value>> volume;
  bool is_writable = false;
  std::vector<std::string> warnings{};  ///< Of the import.
  std::string source_kind{};            ///< Of the import: "NRRD".

  [[nodiscard]] const image::Volume<Value>& operator*() const { return *volume; }
};

using OwnedCt = OwnedVolume<std::int16_t>;
using OwnedLabels = OwnedVolume<anatomy::Tissue>;
using OwnedScalars = OwnedVolume<float>;

template <class Value>
[[nodiscard]] OwnedVolume<Value> owned(image::Volume<Value> volume) {
  return {std::make_shared<image::Volume<Value>>(std::move(volume))};
}

/// Raises InvalidArgument unless both are on the same grid.
void check_same_grid(const image::Grid& ct, const image::Grid& labels);

void bind_volumes(pybind11::module_& module);

}  // namespace lefort::python
