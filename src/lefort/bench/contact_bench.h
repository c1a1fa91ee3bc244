/// \file
/// `lefort bench contact`: a ball pressed into a block and slid along it, compared with CalculiX.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>

#include <filesystem>
#include <string>

namespace lefort::bench {

struct ContactBenchOptions {
  std::filesystem::path output;  ///< Folder for contact.md and contact.json.
  int threads = 2;
  int repeats = 3;        ///< Runs of lefort; the median is reported.
  bool with_peer = true;  ///< Also run CalculiX, once with each formulation.
};

/// Runs the problem of ball_problem.h.
///
/// \param options   of the benchmark.
/// \param progress  may stop the benchmark.
/// \returns the table as Markdown, which is also written to contact.md; kInvalidArgument if
///   CalculiX is not installed; kNotConverged if lefort does not reach the end; kFileUnwritable,
///   kCancelled. A formulation of CalculiX that does not converge is reported in the table.
[[nodiscard]] Result<std::string> run_contact_bench(const ContactBenchOptions& options,
                                                    Progress& progress);

}  // namespace lefort::bench
