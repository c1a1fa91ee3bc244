/// \file
/// Runs a function of `pipeline`.
#pragma once

#include <lefort/pipeline/summary.h>

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <string>
#include <utility>
#include <vector>

#include "call.h"

namespace lefort::python {

/// The summary in JSON, and the warnings.
using TaskResult = std::pair<std::string, std::vector<std::string>>;

template <class Work>
TaskResult run_task(const CallOptions& options, const Work& work) {
  PythonProgress progress(options);
  const pipeline::Summary summary = call(progress, options.threads, work);
  return {summary.json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace),
          progress.warnings()};
}

}  // namespace lefort::python
