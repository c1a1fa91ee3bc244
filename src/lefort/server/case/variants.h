/// \file
/// Variants: named copies of the plan of a case with its check, and its prediction if there is one,
/// in `variants/NAME/` of the case folder.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/server/case/case_folder.h>
#include <lefort/server/case/case_jobs.h>
#include <lefort/server/case/jobs.h>

#include <nlohmann/json.hpp>

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace lefort::server {

inline constexpr std::size_t kMaxKeptVariants = 12;  ///< Of a case, as in the contract.

/// Whether `name` is a valid name of a variant: 1 to 40 letters, digits, `_` and `-`.
[[nodiscard]] bool is_variant_name(std::string_view name);

/// The folder of a variant, whether it exists or not. `lefort plan variants` reads it.
/// \pre is_variant_name(name).
[[nodiscard]] std::filesystem::path variant_folder(const CaseFolder& folder, std::string_view name);

/// The predicted skin of a variant, whether it exists or not.
/// \pre is_variant_name(name).
[[nodiscard]] std::filesystem::path face_of_variant(const CaseFolder& folder,
                                                    std::string_view name);

/// The variants of a case, sorted by name (contract/openapi.json, VariantList).
[[nodiscard]] nlohmann::json list_variants(const CaseFolder& folder);

/// Keeps the plan of the case, its landmarks and painted boundary if the plan names them, its
/// check, and its prediction if that is up to date and converged. All of it is stored or nothing.
/// No job may run meanwhile.
///
/// \returns nothing, or
///   - kInvalidArgument  an invalid name, or one that is used, or too many variants; a check that
///     is missing or out of date;
///   - kFileUnwritable   a file cannot be written.
[[nodiscard]] Result<void> keep_variant(const CaseFolder& folder, const std::string& name);

/// Makes a variant the plan of the case again, with what keep_variant() stored. A prediction of
/// the case stays if the variant has none; it is then out of date. No job may run meanwhile.
///
/// \returns nothing, or
///   - kFileNotFound     no such variant;
///   - kInvalidArgument  it was made on another scan;
///   - kFileCorrupt      it is damaged;
///   - kFileUnwritable   a file cannot be written; until all files are copied, nothing is changed.
[[nodiscard]] Result<void> load_variant(CaseFolder& folder, const std::string& name);

/// Removes a variant.
///
/// \returns nothing, or kFileNotFound, kFileUnwritable.
[[nodiscard]] Result<void> delete_variant(const CaseFolder& folder, const std::string& name);

/// Fingerprints of the variants that were put side by side; nothing if one was removed.
[[nodiscard]] std::optional<CaseFolder::Inputs> inputs_of_variants(const CaseFolder& folder);

/// The job `variants`: puts variants side by side by pipeline::compare_variants().
[[nodiscard]] Result<JobOutcome> variants_job(const JobContext&, const JobRecord&, Progress&);

}  // namespace lefort::server
