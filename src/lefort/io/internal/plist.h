/// \file
/// Apple property lists in XML, as InVesalius stores its projects.
#pragma once

#include <lefort/core/error.h>

#include <map>
#include <string>
#include <string_view>

namespace lefort::io {

/// The leaves of a property list by their place: {"matrix/shape/0": "108", "spacing/2": "1.5"}.
using FlatPlist = std::map<std::string, std::string>;

/// Reads a property list. Hostile text is harmless: entities are refused, nothing is fetched, and
/// depth and size are limited.
///
/// \returns the leaves, or kFileCorrupt with a sentence that does not name the file.
[[nodiscard]] Result<FlatPlist> read_plist(std::string_view xml);

}  // namespace lefort::io
