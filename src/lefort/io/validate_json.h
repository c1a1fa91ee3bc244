/// \file
/// Validation of JSON by a schema.
#pragma once

#include <lefort/core/error.h>

#include <string>
#include <string_view>

namespace lefort::io {

/// Validates JSON text by a schema.
///
/// \param text     to validate.
/// \param schema   JSON Schema, draft 7, in JSON.
/// \param subject  name of the document in messages.
/// \returns nothing, or kPlanInvalid with the key and its error, as `tissue: unknown key "color"`.
///   Repeated keys in an object, deep nesting and more than a million values are errors.
[[nodiscard]] Result<void> validate_json(std::string_view text, const std::string& schema,
                                         const std::string& subject);

}  // namespace lefort::io
