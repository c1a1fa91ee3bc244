/// \file
/// Apple property lists in XML, the format of main.plist in InVesalius projects.
#pragma once

#include <lefort/core/error.h>

#include <map>
#include <string>
#include <string_view>

namespace lefort::io {

/// The leaves of a property list by path: {"matrix/shape/0": "108", "spacing/2": "1.5"}.
using FlatPlist = std::map<std::string, std::string>;

/// Parses an untrusted property list: entities are rejected, nothing is fetched, depth and size are
/// limited.
///
/// \param xml  the text.
/// \returns the leaves, or kFileCorrupt; the message does not contain the file name.
[[nodiscard]] Result<FlatPlist> read_plist(std::string_view xml);

}  // namespace lefort::io
