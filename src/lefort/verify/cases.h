/// \file
/// The cases. Punch and ironing are in rigid_contact.cpp, uncertainty in uncertain_bar.cpp; each
/// other case has a .cpp of its own. Each function returns the section of its case, whose checks
/// may have failed; `progress` may stop it.
#pragma once

#include <lefort/verify/run_suite.h>

namespace lefort::verify {

[[nodiscard]] Section verify_patch(Extent extent, Progress& progress);
[[nodiscard]] Section verify_convergence(Extent extent, Progress& progress);
[[nodiscard]] Section verify_laws(Extent extent, Progress& progress);
[[nodiscard]] Section verify_newton(Extent extent, Progress& progress);
[[nodiscard]] Section verify_inf_sup(Extent extent, Progress& progress);
[[nodiscard]] Section verify_cook(Extent extent, Progress& progress);
[[nodiscard]] Section verify_inflation(Extent extent, Progress& progress);
[[nodiscard]] Section verify_torsion(Extent extent, Progress& progress);
[[nodiscard]] Section verify_bulging(Extent extent, Progress& progress);
[[nodiscard]] Section verify_bending(Extent extent, Progress& progress);
[[nodiscard]] Section verify_cardiac(Extent extent, Progress& progress);
[[nodiscard]] Section verify_hertz(Extent extent, Progress& progress);
[[nodiscard]] Section verify_punch(Extent extent, Progress& progress);
[[nodiscard]] Section verify_ironing(Extent extent, Progress& progress);
[[nodiscard]] Section verify_uncertainty(Extent extent, Progress& progress);

}  // namespace lefort::verify
