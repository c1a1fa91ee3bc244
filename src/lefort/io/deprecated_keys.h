/// \file
/// Deprecated names of keys and options, which are accepted for one version with a warning.
#pragma once

#include <lefort/core/progress.h>

#include <span>
#include <string>
#include <string_view>

namespace lefort::io {

/// A key of a plan or deck that has a new name.
struct DeprecatedKey {
  std::string_view object;  ///< Path of its object, as "segments[].path"; empty: the top level.
  std::string_view old_key;
  std::string_view new_key;
};

/// A value of a key that has a new name.
struct DeprecatedValue {
  std::string_view object;  ///< As in DeprecatedKey.
  std::string_view key;     ///< New name of the key.
  std::string_view old_value;
  std::string_view new_value;
};

/// The deprecated names of one file format.
struct DeprecatedNames {
  std::span<const DeprecatedKey> keys;
  std::span<const DeprecatedValue> values;
};

[[nodiscard]] DeprecatedNames deprecated_in_plans();
[[nodiscard]] DeprecatedNames deprecated_in_decks();

/// Passes each warning of a plan or deck to `progress`.
void note_warnings(std::span<const std::string> warnings, Progress& progress);

/// An option of the command line that has a new name.
struct DeprecatedOption {
  std::string_view command;  ///< Without the program, for example "bench solve".
  std::string_view old_option;
  std::string_view new_option;
};

[[nodiscard]] std::span<const DeprecatedOption> deprecated_options();

}  // namespace lefort::io
