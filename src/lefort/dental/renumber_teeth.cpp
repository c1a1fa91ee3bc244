#include <lefort/dental/renumber_teeth.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>

namespace lefort::dental {
namespace {

/// Whether both numbers are of upper teeth, or both of lower ones.
bool is_same_jaw(int a, int b) { return (a / 10 <= 2) == (b / 10 <= 2); }

Result<void> check_correction(const NumberedTeeth& teeth, const ToothCorrection& one) {
  const bool is_known = std::any_of(teeth.teeth.begin(), teeth.teeth.end(),
                                    [&](const auto& tooth) { return tooth.fdi == one.found; });
  if (!is_known)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("no tooth was found with the number {}", one.found));
  if (one.fdi != 0 && !is_fdi_number(one.fdi))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{} is no FDI number, must be 11 to 48, or 0 for no tooth", one.fdi));
  if (one.fdi != 0 && !is_same_jaw(one.found, one.fdi))
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("tooth {} cannot be {}, which is in the other jaw", one.found, one.fdi));
  return {};
}

}  // namespace

Result<NumberedTeeth> renumbered(NumberedTeeth teeth,
                                 std::span<const ToothCorrection> corrections) {
  std::array<std::uint8_t, 256> number{};
  std::iota(number.begin(), number.end(), std::uint8_t(0));
  for (const ToothCorrection& one : corrections) {
    LEFORT_TRY_VOID(check_correction(teeth, one));
    const auto same = std::count_if(corrections.begin(), corrections.end(),
                                    [&](auto& other) { return other.found == one.found; });
    if (same > 1)
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("tooth {} is corrected twice", one.found));
    number[std::size_t(one.found)] = std::uint8_t(one.fdi);
  }
  for (NumberedTooth& tooth : teeth.teeth) tooth.fdi = int(number[std::size_t(tooth.fdi)]);
  std::erase_if(teeth.teeth, [](const NumberedTooth& tooth) { return tooth.fdi == 0; });
  std::sort(teeth.teeth.begin(), teeth.teeth.end(),
            [](const auto& a, const auto& b) { return a.fdi < b.fdi; });
  const auto twice = std::adjacent_find(teeth.teeth.begin(), teeth.teeth.end(),
                                        [](auto& a, auto& b) { return a.fdi == b.fdi; });
  if (twice != teeth.teeth.end())
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("two teeth would have the number {}", twice->fdi));
  for (std::uint8_t& value : teeth.numbers.values) value = number[value];
  teeth.missing = missing_numbers(teeth.teeth);
  return teeth;
}

}  // namespace lefort::dental
