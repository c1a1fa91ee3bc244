#include <lefort/io/internal/rename_keys.h>

#include <fmt/format.h>

#include <string_view>
#include <utility>

namespace lefort::io::internal {
namespace {

using Json = nlohmann::json;

/// The objects at a path such as "segments[].osteotomy"; "" is `json` itself.
std::vector<Json*> objects_at(Json& json, std::string_view path) {
  if (!json.is_object()) return {};
  if (path.empty()) return {&json};
  const std::size_t dot = path.find('.');
  std::string_view key = path.substr(0, dot);
  const std::string_view rest = dot == path.npos ? "" : path.substr(dot + 1);
  const bool is_list = key.ends_with("[]");
  if (is_list) key.remove_suffix(2);
  const auto found = json.find(std::string(key));
  if (found == json.end()) return {};
  if (!is_list) return objects_at(*found, rest);
  std::vector<Json*> objects;
  if (!found->is_array()) return objects;
  for (Json& item : *found)
    for (Json* const object : objects_at(item, rest)) objects.push_back(object);
  return objects;
}

std::string joined(std::string_view object, std::string_view key) {
  return object.empty() ? std::string(key) : fmt::format("{}.{}", object, key);
}

/// \returns whether the key occurs.
Result<bool> rename(Json& json, const DeprecatedKey& name) {
  bool occurs = false;
  for (Json* const object : objects_at(json, name.object)) {
    const auto old_value = object->find(std::string(name.old_key));
    if (old_value == object->end()) continue;
    if (object->contains(std::string(name.new_key)))
      return fail(ErrorCode::kPlanInvalid,
                  fmt::format("{}: must have one of {} and {}, its deprecated name",
                              joined(name.object, name.new_key), name.new_key, name.old_key));
    Json value = std::move(*old_value);
    object->erase(old_value);
    (*object)[std::string(name.new_key)] = std::move(value);
    occurs = true;
  }
  return occurs;
}

/// \returns whether the value occurs.
bool rename(Json& json, const DeprecatedValue& name) {
  bool occurs = false;
  for (Json* const object : objects_at(json, name.object)) {
    const auto value = object->find(std::string(name.key));
    if (value == object->end() || *value != name.old_value) continue;
    *value = name.new_value;
    occurs = true;
  }
  return occurs;
}

}  // namespace

Result<std::vector<std::string>> rename_deprecated(Json& json, const DeprecatedNames& names) {
  std::vector<std::string> warnings;
  for (const DeprecatedKey& name : names.keys) {
    LEFORT_TRY(const bool occurs, rename(json, name));
    if (occurs)
      warnings.push_back(
          fmt::format("{} is deprecated, use {}", joined(name.object, name.old_key), name.new_key));
  }
  for (const DeprecatedValue& name : names.values)
    if (rename(json, name))
      warnings.push_back(fmt::format("{}: {} is deprecated, use {}", joined(name.object, name.key),
                                     name.old_value, name.new_value));
  return warnings;
}

}  // namespace lefort::io::internal
