/// \file
/// JSON that was checked against one of our schemas: what plans and decks are read from.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/geometry/rigid_path.h>
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

/// A bone's or an obstacle's way.
[[nodiscard]] std::vector<geometry::Keyframe> read_keyframes(const Json& keyframes);

}  // namespace lefort::io::internal
