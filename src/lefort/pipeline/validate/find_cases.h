/// \file
/// The files of a cohort.
#pragma once

#include <lefort/core/error.h>

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lefort::pipeline {

/// Surfaces of one head.
struct SurfaceFiles {
  std::optional<std::filesystem::path> skin{}, skull{}, mandible{};
};

/// The files of one case.
struct CohortCase {
  std::string name;
  std::filesystem::path folder;
  std::optional<std::filesystem::path> before_scan{};  ///< A file, or a folder of DICOM files.
  SurfaceFiles before;                                 ///< Instead of a scan.
  std::optional<std::filesystem::path> after_scan{};
  SurfaceFiles after;                           ///< Instead of a scan.
  std::optional<std::filesystem::path> plan{};  ///< Of the case, or of the cohort.
  std::optional<std::filesystem::path> landmarks{};

  [[nodiscard]] bool has_after() const { return after_scan || after.skin; }
  /// Role and path of each file or folder that exists.
  [[nodiscard]] std::vector<std::pair<std::string, std::filesystem::path>> inputs() const;
};

/// Files that the plan of a case names and that exist, in the order of the plan. A plan that is not
/// valid names none.
[[nodiscard]] std::vector<std::filesystem::path> files_of_plan(const CohortCase& one);

/// Whether a folder is a BIDS dataset: it contains a folder sub-LABEL.
[[nodiscard]] bool is_bids_dataset(const std::filesystem::path& cohort);

/// Lists the case folders of a cohort by name; folders whose names start with a dot are ignored. In
/// a BIDS dataset \cite gorgolewski2016 only the folders sub-LABEL are cases.
///
/// \param cohort  the folder.
/// \returns the folders; kFileNotFound if the cohort is not a folder; kInvalidArgument if it
///   contains none.
[[nodiscard]] Result<std::vector<std::filesystem::path>> list_cases(
    const std::filesystem::path& cohort);

/// Whether a case without a face after surgery is an error.
enum class AfterSurgery { kRequired, kOptional };

/// Finds the files of a case by their names: before.nrrd, ... or, in a folder sub-LABEL,
/// ct/sub-LABEL_ct.nii.gz, ... (docs/guide/validate.md, docs/guide/cohorts.md).
///
/// \param folder  of the case, as listed by list_cases().
/// \param after   whether the face after surgery may be missing.
/// \returns the case; kInvalidArgument if the head before or after surgery is missing or ambiguous;
///   or kFileNotFound if the folder cannot be listed.
[[nodiscard]] Result<CohortCase> find_case(const std::filesystem::path& folder,
                                           AfterSurgery after = AfterSurgery::kRequired);

/// Hash of the contents of all inputs of a case, and of the files that its plan names. The names of
/// the inputs and the place of the cohort do not matter; the order of names in a folder of DICOM
/// files does.
///
/// \returns 64 hexadecimal digits, or the errors of io::sha256_of_file().
[[nodiscard]] Result<std::string> fingerprint_case(const CohortCase& one);

/// A message without the paths of the cohort and the output, which may identify a person.
[[nodiscard]] std::string without_paths(std::string message, const std::filesystem::path& cohort,
                                        const std::filesystem::path& output);

}  // namespace lefort::pipeline
