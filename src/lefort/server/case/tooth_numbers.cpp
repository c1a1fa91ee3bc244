#include <lefort/server/case/tooth_numbers.h>

#include <fmt/format.h>

#include <map>
#include <optional>
#include <set>

namespace lefort::server {
namespace {

using nlohmann::json;

/// Whether both are numbers of upper teeth, or both of lower ones.
bool are_of_one_jaw(int a, int b) { return (a / 10 <= 2) == (b / 10 <= 2); }

/// An integer member; nothing if it is something else.
std::optional<int> integer_in(const json& object, const char* key) {
  if (!object.is_object()) return std::nullopt;
  const auto at = object.find(key);
  if (at == object.end() || !at->is_number_integer()) return std::nullopt;
  return at->get<int>();
}

/// The numbers that were found, from teeth.json, which any program may have written.
std::set<int> numbers_found(const json& teeth) {
  std::set<int> numbers;
  const auto list = teeth.find("teeth");
  if (list == teeth.end() || !list->is_array()) return numbers;
  for (const json& tooth : *list) {
    const auto found = integer_in(tooth, "found"), fdi = integer_in(tooth, "fdi");
    if (found || fdi) numbers.insert(found ? *found : *fdi);
  }
  return numbers;
}

}  // namespace

json with_found_numbers(json teeth, const json& applied) {
  const auto corrections = applied.is_object() ? applied.find("corrections") : applied.end();
  if (!applied.is_object() || corrections == applied.end() || !corrections->is_array() ||
      !teeth.is_object() || !teeth.contains("teeth") || !teeth["teeth"].is_array())
    return teeth;
  std::map<int, int> found;
  for (const json& one : *corrections) {
    const auto from = integer_in(one, "found"), to = integer_in(one, "fdi");
    if (from && to) found[*to] = *from;
  }
  for (json& tooth : teeth["teeth"])
    if (const auto fdi = integer_in(tooth, "fdi"); fdi && found.contains(*fdi))
      tooth["found"] = found[*fdi];
  return teeth;
}

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
    if (fdi != 0 && !are_of_one_jaw(found, fdi))
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("tooth {} cannot be {}, which is in the other jaw", found, fdi));
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
