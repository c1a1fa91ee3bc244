#include <lefort/server/case/tooth_numbers.h>

#include <fmt/format.h>

#include <map>
#include <set>

namespace lefort::server {
namespace {

using nlohmann::json;

/// The numbers that were found, from teeth.json, which any program may have written.
std::set<int> numbers_found(const json& teeth) {
  std::set<int> numbers;
  const auto list = teeth.find("teeth");
  if (list == teeth.end() || !list->is_array()) return numbers;
  for (const json& tooth : *list)
    for (const char* key : {"found", "fdi"})
      if (tooth.is_object() && tooth.contains(key) && tooth[key].is_number_integer()) {
        numbers.insert(tooth[key].get<int>());
        break;
      }
  return numbers;
}

}  // namespace

bool is_tooth_number(int fdi) {
  const int quadrant = fdi / 10, place = fdi % 10;
  return quadrant >= 1 && quadrant <= 4 && place >= 1 && place <= 8;
}

Result<void> check_tooth_corrections(const json& corrections, const json& teeth) {
  std::map<int, int> corrected;
  for (const json& one : corrections) {
    const int found = one.at("found").get<int>(), fdi = one.at("fdi").get<int>();
    if (const int wrong = is_tooth_number(found) ? fdi : found;
        wrong != 0 && !is_tooth_number(wrong))
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("{} is no FDI number: 11 to 18, 21 to 28, 31 to 38, 41 to 48, or 0 "
                              "for what is not a tooth",
                              wrong));
    if (!corrected.emplace(found, fdi).second)
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("the tooth that was found as {} is corrected twice", found));
  }
  std::map<int, int> all = corrected;
  for (const int number : numbers_found(teeth)) all.emplace(number, number);
  std::set<int> taken;
  for (const auto& [found, fdi] : all)
    if (fdi != 0 && !taken.insert(fdi).second)
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("two teeth would have the number {}", fdi));
  return {};
}

}  // namespace lefort::server
