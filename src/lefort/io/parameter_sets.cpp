#include <lefort/io/internal/csv.h>
#include <lefort/io/internal/validated_json.h>
#include <lefort/io/parameter_sets.h>
#include <lefort/io/parameter_sets_schema.h>
#include <lefort/io/plan_file.h>
#include <lefort/io/plan_inputs.h>
#include <lefort/io/plan_schema.h>
#include <lefort/io/read_text.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>
#include <sstream>
#include <utility>

namespace lefort::io {
namespace {

namespace fs = std::filesystem;
using OrderedJson = nlohmann::ordered_json;

constexpr std::uintmax_t kMaxSetsBytes = 16 << 20;
constexpr const char* kNameColumn = "set";

/// A plan with nothing but what a plan must have: a set must be valid in it.
constexpr const char* kShortestPlan = R"({"lefort_plan": 1, "segments": [
  {"name": "mandible", "osteotomy": {"bone": "mandible"}, "path": {"keyframes": [{}]}}]})";

/// Checks keys, types and ranges. Whether the values agree with those of a plan is checked with it.
Result<void> check_set(const ParameterSet& set) {
  const auto bad = [&](const std::string& what) {
    return fail(ErrorCode::kPlanInvalid, fmt::format("parameter set {}: {}", set.name, what));
  };
  const Result<std::string> plan = change_plan(kShortestPlan, set);
  if (!plan) return bad(plan.error().message);
  if (const auto checked = internal::parse_checked(*plan, kPlanSchema, "the plan"); !checked)
    return bad(checked.error().message);
  if (const std::vector<std::string> files = files_of_plan(*plan); !files.empty())
    return bad(
        fmt::format("names the file {}, must name none: a set is for all cases", files.front()));
  return {};
}

/// The value of a cell: JSON, or else text.
OrderedJson value_of(const std::string& cell) {
  OrderedJson value = OrderedJson::parse(cell, nullptr, false);
  return value.is_discarded() ? OrderedJson(cell) : value;
}

/// "a.b" as the pointer /a/b.
Result<OrderedJson::json_pointer> pointer_of(const std::string& column) {
  std::string text = "/" + column;
  if (column.empty() || column.find_first_of("/~") != std::string::npos ||
      text.find("..") != std::string::npos || column.front() == '.' || column.back() == '.')
    return fail(ErrorCode::kPlanInvalid,
                fmt::format("the column \"{}\" is no key of a plan: expected a path such as "
                            "tissue.element_size_mm",
                            column));
  std::replace(text.begin(), text.end(), '.', '/');
  return OrderedJson::json_pointer(text);
}

Result<std::vector<OrderedJson::json_pointer>> read_heading(const std::vector<std::string>& heads) {
  if (heads.empty() || heads.front() != kNameColumn)
    return fail(ErrorCode::kPlanInvalid,
                fmt::format("the first column is \"{}\", must be \"{}\"",
                            heads.empty() ? "" : heads.front(), kNameColumn));
  std::vector<OrderedJson::json_pointer> keys;
  for (std::size_t c = 1; c < heads.size(); ++c) {
    if (std::count(heads.begin(), heads.end(), heads[c]) > 1)
      return fail(ErrorCode::kPlanInvalid, fmt::format("the column {} occurs twice", heads[c]));
    LEFORT_TRY(keys.emplace_back(), pointer_of(heads[c]));
  }
  return keys;
}

/// Assigns a value; nothing if a part of the path is a value itself.
bool assign(OrderedJson& set, const OrderedJson::json_pointer& key, OrderedJson value) {
  try {
    set[key] = std::move(value);
    return true;
  } catch (const nlohmann::json::exception&) {
    return false;
  }
}

/// The sets of a table as the JSON of the other format.
Result<std::pair<OrderedJson, std::vector<std::string>>> read_table(const std::string& text) {
  const auto bad = [](const std::string& what) { return fail(ErrorCode::kPlanInvalid, what); };
  std::istringstream lines(text);
  std::vector<OrderedJson::json_pointer> keys;
  OrderedJson sets = OrderedJson::object();
  std::vector<std::string> names;
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty()) continue;
    const auto cells = internal::split_csv(line);
    if (!cells) return bad(fmt::format("line {} has an unclosed quote", number));
    if (number == 1) {
      LEFORT_TRY(keys, read_heading(*cells));
      continue;
    }
    if (cells->size() != keys.size() + 1)
      return bad(fmt::format("line {} has {} cells, the first line has {}", number, cells->size(),
                             keys.size() + 1));
    const std::string& name = cells->front();
    if (sets.contains(name)) return bad(fmt::format("the set {} occurs twice", name));
    OrderedJson& set = sets[name] = OrderedJson::object();
    names.push_back(name);
    for (std::size_t c = 0; c < keys.size(); ++c) {
      const std::string& cell = (*cells)[c + 1];
      if (!cell.empty() && !assign(set, keys[c], value_of(cell)))
        return bad(fmt::format("line {}: {} and a key below it have both a value", number,
                               keys[c].parent_pointer().to_string()));
    }
  }
  return std::pair(OrderedJson{{"lefort_parameter_sets", 1}, {"sets", sets}}, names);
}

/// Names are parts of folder names.
Result<void> check_names(const std::string& json_text) {
  constexpr std::size_t kMaxLength = 40;
  const internal::Json json = internal::Json::parse(json_text, nullptr, false);
  if (!json.is_object() || !json.contains("sets") || !json["sets"].is_object()) return {};
  for (const auto& [name, set] : json["sets"].items())
    if (name.empty() || name.size() > kMaxLength ||
        !std::all_of(name.begin(), name.end(), [](char c) {
          return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
        }))
      return fail(ErrorCode::kPlanInvalid,
                  fmt::format("the set \"{}\" must have a name of 1 to {} letters and digits", name,
                              kMaxLength));
  return {};
}

Result<std::vector<ParameterSet>> parse_sets(const fs::path& file, const std::string& text) {
  constexpr const char* kSubject = "the parameter sets";
  const bool is_table = file.extension() == ".csv";
  std::string json_text = text;
  std::vector<std::string> names;
  if (is_table) {
    LEFORT_TRY(auto table, read_table(text));
    json_text = table.first.dump();
    names = std::move(table.second);
  }
  LEFORT_TRY_VOID(check_names(json_text));
  LEFORT_TRY(const internal::Json json,
             internal::parse_checked(json_text, kParameterSetsSchema, kSubject));
  if (!is_table)
    for (const auto& [name, set] : json["sets"].items()) names.push_back(name);
  std::vector<ParameterSet> sets;
  for (const std::string& name : names) {
    sets.push_back({name, json["sets"][name].dump()});
    LEFORT_TRY_VOID(check_set(sets.back()));
  }
  return sets;
}

}  // namespace

Result<std::vector<ParameterSet>> read_parameter_sets(const fs::path& file) {
  LEFORT_TRY(const std::string text, read_text(file, kMaxSetsBytes));
  auto sets = parse_sets(file, text);
  if (sets) return sets;
  return fail(sets.error().code,
              fmt::format("{}: {}", file.filename().string(), sets.error().message));
}

Result<std::vector<ParameterSet>> select_sets(std::vector<ParameterSet> all,
                                              std::span<const std::string> names) {
  if (names.empty()) return all;
  const std::set<std::string> wanted(names.begin(), names.end());
  if (wanted.size() != names.size())
    return fail(ErrorCode::kInvalidArgument, "a parameter set is named twice");
  std::vector<ParameterSet> chosen;
  std::vector<std::string> known;
  for (ParameterSet& set : all) {
    known.push_back(set.name);
    if (wanted.contains(set.name)) chosen.push_back(std::move(set));
  }
  for (const std::string& name : names)
    if (std::find(known.begin(), known.end(), name) == known.end())
      return fail(
          ErrorCode::kInvalidArgument,
          fmt::format("there is no parameter set {}; there are {}{}", name,
                      fmt::join(known.begin(),
                                known.begin() + std::min<long>(20, long(known.size())), ", "),
                      known.size() > 20 ? ", ..." : ""));
  return chosen;
}

Result<std::string> change_plan(const std::string& plan, const ParameterSet& set) {
  LEFORT_TRY(const std::string base, rename_plan_keys(plan));
  LEFORT_TRY(const std::string overrides, rename_plan_keys(set.overrides));
  OrderedJson changed = OrderedJson::parse(base);  // rename_plan_keys() has parsed both.
  changed.merge_patch(OrderedJson::parse(overrides));
  return changed.dump(2) + "\n";
}

}  // namespace lefort::io
