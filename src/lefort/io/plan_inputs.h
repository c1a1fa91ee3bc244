/// \file
/// The input files of a plan.
#pragma once

#include <lefort/core/error.h>
#include <lefort/io/plan_file.h>

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace lefort::io {

/// Returns the path of the scan: `given`, or else the one in the plan.
///
/// \param plan_file  path of the plan, for the message.
/// \param plan       the plan.
/// \param given      path from the command line.
/// \returns the path, kPlanInvalid if neither is there, or kFileNotFound.
[[nodiscard]] Result<std::filesystem::path> scan_of(
    const std::filesystem::path& plan_file, const PlanFile& plan,
    const std::optional<std::filesystem::path>& given);

/// A file and its hash.
struct InputFile {
  std::string name;    ///< As in the plan.
  std::string sha256;  ///< 64 hexadecimal digits.
  bool operator==(const InputFile&) const = default;
};

/// Returns the files of a plan other than the scan, with their names in the plan.
///
/// \param text  of a valid plan.
[[nodiscard]] std::vector<std::string> files_of_plan(const std::string& text);

/// Returns the files of files_of_plan() with their hashes, which show whether an input of a result
/// has changed.
///
/// \param text       of a valid plan.
/// \param plan_file  path of the plan.
/// \returns one entry per file, or the errors of sha256_of_file().
[[nodiscard]] Result<std::vector<InputFile>> fingerprints(const std::string& text,
                                                          const std::filesystem::path& plan_file);

/// Returns the text of the plan with other names of its files, except that of the scan.
///
/// \param text      of a valid plan.
/// \param new_name  of the file with the given name.
[[nodiscard]] std::string rename_files(
    const std::string& text, const std::function<std::string(const std::string&)>& new_name);

/// Returns the text of a copy of the plan with paths relative to the folder of the copy.
///
/// \param text       of a valid plan.
/// \param plan_file  path of the plan.
/// \param ct         path of the scan.
/// \param folder     of the copy.
[[nodiscard]] std::string portable_plan(const std::string& text,
                                        const std::filesystem::path& plan_file,
                                        const std::filesystem::path& ct,
                                        const std::filesystem::path& folder);

}  // namespace lefort::io
