/// \file
/// All verification cases of the finite element solver, by name.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/verify/check.h>

#include <span>
#include <string>
#include <vector>

namespace lefort::verify {

/// Mesh refinement: the short form runs as a test, the full form makes the report.
enum class Extent { kShort, kFull };

struct Case {
  const char* name;
  Section (*run)(Extent extent, Progress& progress);
};

/// In the order of the report.
[[nodiscard]] std::span<const Case> all_cases();

struct SuiteOptions {
  Extent extent = Extent::kShort;
  std::string only;  ///< Name of one case; empty for all.
};

/// \param options   extent and cases.
/// \param progress  may stop the suite.
/// \returns one section per case, whether or not its checks passed; or kInvalidArgument for an
///   unknown name, or kCancelled.
[[nodiscard]] Result<std::vector<Section>> run_suite(const SuiteOptions& options,
                                                     Progress& progress);

}  // namespace lefort::verify
