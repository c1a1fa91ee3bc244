#include <lefort/verify/cases.h>
#include <lefort/verify/run_suite.h>

#include <fmt/format.h>

#include <array>
#include <string_view>

namespace lefort::verify {
namespace {

constexpr std::array kCases{
    Case{"patch", verify_patch},
    Case{"convergence", verify_convergence},
    Case{"laws", verify_laws},
    Case{"newton", verify_newton},
    Case{"inf-sup", verify_inf_sup},
    Case{"cook", verify_cook},
    Case{"inflation", verify_inflation},
    Case{"torsion", verify_torsion},
    Case{"bulging", verify_bulging},
    Case{"bending", verify_bending},
    Case{"cardiac", verify_cardiac},
    Case{"hertz", verify_hertz},
    Case{"punch", verify_punch},
    Case{"ironing", verify_ironing},
    Case{"uncertainty", verify_uncertainty},
};

}  // namespace

std::span<const Case> all_cases() { return kCases; }

Result<std::vector<Section>> run_suite(const SuiteOptions& options, Progress& progress) {
  std::vector<Section> sections;
  for (const Case& one : kCases) {
    if (!options.only.empty() && options.only != one.name) continue;
    progress.begin_stage(fmt::format("verify {}", one.name));
    sections.push_back(one.run(options.extent, progress));
    if (progress.stop_requested())
      return fail(ErrorCode::kCancelled, fmt::format("cancelled during {}", one.name));
  }
  if (sections.empty())
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("there is no verification case '{}'; see lefort verify --help", options.only));
  return sections;
}

}  // namespace lefort::verify
