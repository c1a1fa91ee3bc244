#include <lefort/plan/check_volumes.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lefort::plan {

Result<void> check_volumes(const std::string& cut, double whole_mm3,
                           const std::vector<double>& parts_mm3) {
  constexpr double kOfWhole = 1e-3, kOfMinPart = 1e-2;  // Tolerances, as fractions.
  double sum_mm3 = 0.0, allowed_mm3 = kOfWhole * whole_mm3;
  for (const double part_mm3 : parts_mm3) {
    sum_mm3 += part_mm3;
    if (part_mm3 > 0.0) allowed_mm3 = std::min(allowed_mm3, kOfMinPart * part_mm3);
  }
  if (std::abs(sum_mm3 - whole_mm3) <= allowed_mm3) return {};
  return fail(ErrorCode::kMeshingFailed,
              fmt::format("{}: the parts hold {:.4f} ml, the bone {:.4f} ml, must be "
                          "equal within {:.2g} ml: the surface of the bone may cross itself",
                          cut, sum_mm3 * 1e-3, whole_mm3 * 1e-3, allowed_mm3 * 1e-3));
}

}  // namespace lefort::plan
