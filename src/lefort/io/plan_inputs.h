/// \file
/// The files that a plan names.
#pragma once

#include <lefort/core/error.h>
#include <lefort/io/plan_file.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lefort::io {

/// The scan that `given` names, or else the plan.
///
/// \returns kPlanInvalid if neither does, kFileNotFound if it is not there.
[[nodiscard]] Result<std::filesystem::path> scan_of(
    const std::filesystem::path& plan_file, const PlanFile& plan,
    const std::optional<std::filesystem::path>& given);

/// A file and its bytes' fingerprint.
struct InputFile {
  std::string name;    ///< As the plan has it.
  std::string sha256;  ///< 64 hexadecimal digits.
  bool operator==(const InputFile&) const = default;
};

/// The files that a plan which was read names, but for the scan; relative to the plan's folder.
[[nodiscard]] std::vector<std::string> file_catalog(const std::string& text);

/// What they hold, so that a result tells when one of them has changed.
///
/// \returns as many, or what sha256_of_file() returns.
[[nodiscard]] Result<std::vector<InputFile>> fingerprints(const std::string& text,
                                                          const std::filesystem::path& plan_file);

/// The plan's text with its files named as seen from the folder the copy goes to.
[[nodiscard]] std::string portable_plan(const std::string& text,
                                        const std::filesystem::path& plan_file,
                                        const std::filesystem::path& ct,
                                        const std::filesystem::path& folder);

}  // namespace lefort::io
