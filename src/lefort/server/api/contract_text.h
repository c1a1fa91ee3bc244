/// \file
/// Files embedded in the program by cmake/embed_files.py.
#pragma once

#include <string_view>

namespace lefort::server {

extern const std::string_view kContract;          ///< contract/openapi.json.
extern const std::string_view kExampleLandmarks;  ///< examples/cranium_landmarks.mrk.json.

}  // namespace lefort::server
