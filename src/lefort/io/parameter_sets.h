/// \file
/// Parameter sets: named changes of plans, from JSON or CSV.
#pragma once

#include <lefort/core/error.h>

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace lefort::io {

/// A named change of plans.
struct ParameterSet {
  std::string name;       ///< Letters and digits.
  std::string overrides;  ///< Keys of a plan with other values: JSON; "{}" for none.
};

/// The set of a run without a file: the plans as they are.
[[nodiscard]] inline ParameterSet default_set() { return {"default", "{}"}; }

/// Reads contract/parameter_sets.schema.json, or a CSV: one line per set, the column `set` with its
/// name, each other column with the path of a key of a plan ("tissue.element_size_mm"). An empty
/// cell leaves the plan as it is.
///
/// \param file  its ending chooses the format: .json or .csv.
/// \returns the sets in the order of the file (JSON: by name); kFileNotFound; kFileCorrupt if it is
///   larger than 16 MiB; or kPlanInvalid with the set, the key and the error, as
///   `parameter set stiff: tissue: unknown key 'color'`.
[[nodiscard]] Result<std::vector<ParameterSet>> read_parameter_sets(
    const std::filesystem::path& file);

/// \param names  of sets; empty: all.
/// \returns the named sets, in the order of `all`; kInvalidArgument for a name that is unknown or
///   repeated.
[[nodiscard]] Result<std::vector<ParameterSet>> select_sets(std::vector<ParameterSet> all,
                                                            std::span<const std::string> names);

/// Merges a set into a plan \cite rfc7396. Deprecated keys of both are renamed before.
///
/// \returns the text of the changed plan, which is not checked; or kPlanInvalid if one of the two
///   is not JSON.
[[nodiscard]] Result<std::string> change_plan(const std::string& plan, const ParameterSet& set);

}  // namespace lefort::io
