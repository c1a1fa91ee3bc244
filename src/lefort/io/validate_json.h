/// \file
/// JSON of others, held against a schema.
#pragma once

#include <lefort/core/error.h>

#include <string>
#include <string_view>

namespace lefort::io {

/// Whether a text is JSON that a schema accepts.
///
/// \param schema   JSON Schema, draft 7, in JSON.
/// \param subject  what the whole is called in messages.
/// \returns nothing, or kPlanInvalid with the key and what is wrong with it, as `tissue: unknown
///   key "color"`. A key that stands twice in an object is wrong, and so is deep nesting.
[[nodiscard]] Result<void> validate_json(std::string_view text, const std::string& schema,
                                         const std::string& subject);

}  // namespace lefort::io
