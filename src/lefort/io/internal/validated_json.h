/// \file
/// JSON that is validated by a schema, for plans and decks.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/geometry/rigid_path.h>
#include <lefort/io/deprecated_keys.h>
#include <lefort/plan/plan.h>

#include <nlohmann/json.hpp>

#include <string>
#include <string_view>
#include <vector>

namespace lefort::io::internal {

using Json = nlohmann::json;

/// Parses `text` and validates it.
///
/// \param schema   JSON Schema, draft 7, in JSON.
/// \param subject  name of the document in messages: "the plan".
/// \returns the JSON, or kPlanInvalid with the key and its error, as `tissue: unknown key "color"`.
///   A repeated key in an object is an error, since parsers differ on it; so are nesting of more
///   than 32 levels, which would exhaust the stack of recursive code, and more than a million
///   values, which would exhaust memory.
[[nodiscard]] Result<Json> parse_checked(std::string_view text, const char* schema,
                                         const std::string& subject);

/// JSON that was checked, and a warning for each of its deprecated names.
struct CheckedJson {
  Json json;  ///< With the new names.
  std::vector<std::string> warnings;
};

/// As above for a plan or deck, whose deprecated keys and values are renamed before the check.
[[nodiscard]] Result<CheckedJson> parse_checked(std::string_view text, const char* schema,
                                                const std::string& subject,
                                                const DeprecatedNames& deprecated);

/// Parses a plan or deck and renames its deprecated keys and values, without a check.
[[nodiscard]] Result<CheckedJson> parse_renamed(std::string_view text,
                                                const DeprecatedNames& deprecated);

/// Sets `value` if the object has the key, whose type the schema has checked.
template <class T>
void read(const Json& object, const char* key, T& value) {
  if (const auto found = object.find(key); found != object.end()) value = found->get<T>();
}

[[nodiscard]] inline Vec3 as_vector(const Json& json) {
  return {json[0].get<double>(), json[1].get<double>(), json[2].get<double>()};
}

inline void read(const Json& object, const char* key, Vec3& value) {
  if (const auto found = object.find(key); found != object.end()) value = as_vector(*found);
}

/// Returns the object at `key`, or an empty one. The reference is valid as long as `whole`.
[[nodiscard]] const Json& section(const Json& whole, const char* key);
[[nodiscard]] const Json& section(Json&& whole, const char* key) = delete;

/// Returns the list at `key`, or an empty one. The reference is valid as long as `whole`.
[[nodiscard]] const Json& list(const Json& whole, const char* key);
[[nodiscard]] const Json& list(Json&& whole, const char* key) = delete;

/// Reads the keyframes of the rigid path of a bone or an obstacle.
///
/// \param keyframes  list of keyframes.
/// \param at_key     key of the path parameter: "path_fraction" or "time".
[[nodiscard]] std::vector<geometry::Keyframe> read_keyframes(const Json& keyframes,
                                                             const char* at_key);

}  // namespace lefort::io::internal
