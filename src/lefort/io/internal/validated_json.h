/// \file
/// JSON that was checked against one of our schemas: what plans and decks are read from.
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

/// Parses `text` and checks it.
///
/// \param schema   JSON Schema, draft 7, in JSON.
/// \param subject  what the whole is called in messages: "the plan".
/// \returns kPlanInvalid with the key and what is wrong with it, as `tissue: unknown key "color"`.
///   A key that stands twice in an object is wrong, since parsers differ on it; so is nesting far
///   beyond what any schema has, which would exhaust the stack of those who walk over it.
[[nodiscard]] Result<Json> parse_checked(std::string_view text, const char* schema,
                                         const std::string& subject);

/// JSON that was checked, and a warning for each of its deprecated names.
struct CheckedJson {
  Json json;  ///< With the new names.
  std::vector<std::string> warnings;
};

/// The same for a plan or deck, whose deprecated keys and values are renamed before the check.
[[nodiscard]] Result<CheckedJson> parse_checked(std::string_view text, const char* schema,
                                                const std::string& subject,
                                                const DeprecatedNames& deprecated);

/// Parses a plan or deck and renames its deprecated keys and values, without a check.
[[nodiscard]] Result<CheckedJson> parse_renamed(std::string_view text,
                                                const DeprecatedNames& deprecated);

/// Sets `value` if the key is there; the schema has checked its type.
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

/// An object within, or an empty one. Lives as long as `whole`.
[[nodiscard]] const Json& section(const Json& whole, const char* key);
[[nodiscard]] const Json& section(Json&& whole, const char* key) = delete;

/// A list within, or an empty one. Lives as long as `whole`.
[[nodiscard]] const Json& list(const Json& whole, const char* key);
[[nodiscard]] const Json& list(Json&& whole, const char* key) = delete;

/// Poses of a bone or an obstacle.
///
/// \param at_key  the key that says when a pose is reached: "path_fraction" or "time".
[[nodiscard]] std::vector<geometry::Keyframe> read_keyframes(const Json& keyframes,
                                                             const char* at_key);

}  // namespace lefort::io::internal
