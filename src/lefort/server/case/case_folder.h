/// \file
/// The folder of one case: its files, and whether each result matches its inputs.
#pragma once

#include <lefort/core/error.h>

#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace lefort::server {

/// File of the painted boundary conditions, as a plan of a case names it.
inline constexpr const char* kBoundaryFile = "boundary.seg.nrrd";
inline constexpr const char* kNerveFile = "nerve/nerve.json";  ///< As a plan names it.

/// A folder that is locked against other servers during the lifetime of this object. Thread-safe.
class CaseFolder {
 public:
  /// Creates the folder if it is missing, accessible to its owner only; otherwise removes what a
  /// killed server left, such as uploads, and completes an interrupted replace_scan().
  ///
  /// \returns the folder, or kFileUnwritable if it cannot be made or written, or another server
  ///   uses it.
  [[nodiscard]] static Result<CaseFolder> open(const std::filesystem::path& folder);
  ~CaseFolder();
  CaseFolder(CaseFolder&&) noexcept;
  CaseFolder& operator=(CaseFolder&&) = delete;

  [[nodiscard]] const std::filesystem::path& root() const { return root_; }
  [[nodiscard]] std::filesystem::path description() const { return root_ / "case.json"; }
  [[nodiscard]] std::filesystem::path ct() const { return root_ / "ct.nrrd"; }
  [[nodiscard]] std::filesystem::path anatomy() const { return root_ / "anatomy"; }
  [[nodiscard]] std::filesystem::path labels() const { return anatomy() / "labels.seg.nrrd"; }
  [[nodiscard]] std::filesystem::path landmarks() const { return root_ / "landmarks.mrk.json"; }
  [[nodiscard]] std::filesystem::path plan() const { return root_ / "plan.json"; }
  /// Boundary conditions painted on the tissue.
  [[nodiscard]] std::filesystem::path boundary() const { return root_ / kBoundaryFile; }
  [[nodiscard]] std::filesystem::path cut() const { return root_ / "cut"; }
  [[nodiscard]] std::filesystem::path check() const { return root_ / "check"; }
  [[nodiscard]] std::filesystem::path preview() const { return root_ / "preview"; }
  [[nodiscard]] std::filesystem::path prediction() const { return root_ / "prediction"; }
  [[nodiscard]] std::filesystem::path comparison() const { return root_ / "comparison"; }
  /// Results of `lefort uncertainty`, of the job or of the command line.
  [[nodiscard]] std::filesystem::path uncertainty() const { return root_ / "uncertainty"; }
  /// Numbered teeth, and corrections of their numbers.
  [[nodiscard]] std::filesystem::path teeth() const { return root_ / "teeth"; }
  [[nodiscard]] std::filesystem::path tooth_corrections() const {
    return root_ / "teeth_corrections.json";
  }
  /// Intraoral scans as uploaded, and in the frame of the CT.
  [[nodiscard]] std::filesystem::path scans() const { return root_ / "intraoral_scans"; }
  [[nodiscard]] std::filesystem::path arches() const { return root_ / "arches"; }
  [[nodiscard]] std::filesystem::path occlusion() const { return root_ / "occlusion"; }
  /// Canals, and corrected points on them.
  [[nodiscard]] std::filesystem::path nerve() const { return root_ / "nerve"; }
  [[nodiscard]] std::filesystem::path nerve_points() const {
    return root_ / "nerve_points.mrk.json";
  }
  /// Cutting guides.
  [[nodiscard]] std::filesystem::path guides() const { return root_ / "guides"; }
  [[nodiscard]] std::filesystem::path airway() const { return root_ / "airway"; }
  [[nodiscard]] std::filesystem::path cephalogram() const { return root_ / "cephalogram"; }
  /// Variants of the plan side by side; and where a variant is prepared or removed.
  [[nodiscard]] std::filesystem::path side_by_side() const { return root_ / "side_by_side"; }
  [[nodiscard]] std::filesystem::path prepared_variant() const { return root_ / "variant"; }
  /// Cached labels, fields and tissue meshes of all stages.
  [[nodiscard]] std::filesystem::path cache() const { return prediction() / "cache"; }
  [[nodiscard]] std::filesystem::path jobs() const { return root_ / "jobs"; }
  [[nodiscard]] std::filesystem::path uploads() const { return root_ / "uploads"; }
  /// Where a scan and its description are prepared for replace_scan().
  [[nodiscard]] std::filesystem::path import_folder() const { return root_ / "import"; }

  /// SHA-256 of a file, cached while the result of stat() is unchanged; nothing if there is no such
  /// file.
  [[nodiscard]] std::optional<std::string> fingerprint(const std::filesystem::path& file) const;

  /// The first 16 digits of fingerprint() as an entity tag, in quotes.
  [[nodiscard]] std::optional<std::string> etag(const std::filesystem::path& file) const;

  /// Fingerprints of the inputs of a stage, by name.
  using Inputs = std::map<std::string, std::string>;

  /// Fingerprints of the present inputs of a stage; nothing if one is missing or the plan is
  /// invalid.
  ///
  /// \param stage  "anatomy", "cut", "check", "preview", "prediction", "comparison",
  ///   "variants", or one of is_measure().
  [[nodiscard]] std::optional<Inputs> inputs_of(std::string_view stage) const;

  /// Stores the fingerprints of the inputs of a stage.
  [[nodiscard]] Result<void> record_inputs(std::string_view stage, const Inputs& inputs);

  /// Stores that landmarks, plan, painted boundary conditions or corrections were made on the
  /// present scan. With another scan they are stale.
  ///
  /// \param stage  "landmarks", "plan", "boundary", kToothCorrections, kNervePoints.
  [[nodiscard]] Result<void> record_scan(std::string_view stage);

  /// Whether what record_scan() or record_inputs() stored is of the present scan; true without a
  /// record.
  [[nodiscard]] bool is_of_scan(std::string_view stage) const;

  /// Replaces scan and description together by those of a folder, which is moved. After an
  /// interruption and the next open() either both are the earlier ones or both are the new ones.
  ///
  /// \param prepared  import_folder() with ct.nrrd and case.json.
  [[nodiscard]] Result<void> replace_scan(const std::filesystem::path& prepared);

  /// The description of the scan; empty if it is missing or belongs to another scan.
  [[nodiscard]] nlohmann::json describe() const;

  /// Removes the documents that mark a stage as computed, so that the results of an earlier job do
  /// not count as results of inputs recorded later.
  ///
  /// \param stage  "cut", "check", "preview", "prediction"; nothing is removed for others.
  [[nodiscard]] Result<void> forget_result(std::string_view stage) const;

  /// State of a stage of kStages (contract/openapi.json, Stage), without jobs.
  [[nodiscard]] nlohmann::json stage(std::string_view stage) const;

 private:
  explicit CaseFolder(std::filesystem::path root, int lock);

  /// Name of the import folder once its scan counts as that of the case; its files are then moved
  /// to their places.
  [[nodiscard]] std::filesystem::path imported() const { return root_ / "imported"; }
  /// The file whose existence shows that a stage is computed, or that it did not converge.
  [[nodiscard]] std::filesystem::path document_of(std::string_view stage) const;
  [[nodiscard]] Result<void> finish_import() const;

  /// Identifies a version of a file. The time alone is not enough: it can be set back, or be too
  /// coarse.
  struct Identity {
    std::uintmax_t device = 0, inode = 0, size = 0;
    std::int64_t modified_s = 0, modified_ns = 0, changed_s = 0, changed_ns = 0;
    bool operator==(const Identity&) const = default;
  };
  struct Known {
    Identity identity;
    std::string sha256;
  };
  std::filesystem::path root_;
  int lock_;
  std::unique_ptr<std::mutex> mutex_;
  mutable std::map<std::filesystem::path, Known> known_;
};

/// Largest size of a document that is read, in bytes; prediction.json has some MB.
inline constexpr std::uintmax_t kMaxDocument = 256 << 20;

/// Whether `file` is a regular file.
[[nodiscard]] bool there_is(const std::filesystem::path& file);

/// Parses JSON of a case folder. The result is discarded() if `text` is not JSON, or is nested so
/// deeply that recursive functions on it could exhaust the stack.
[[nodiscard]] nlohmann::json parse_limited(std::string_view text);

/// The JSON object in a file; empty if the file is missing or damaged.
[[nodiscard]] nlohmann::json read_object(const std::filesystem::path& file);

/// The stages of a case, in order.
inline constexpr const char* kStages[] = {
    "scan",       "anatomy",    "landmarks",    "plan",
    "boundary",   "cut",        "check",        "preview",
    "prediction", "comparison", "uncertainty",  "teeth",
    "arches",     "occlusion",  "splint_final", "splint_intermediate",
    "nerve",      "guides",     "airway",       "cephalogram",
    "variants"};

/// Whether a plan that passed check_files_of_plan() names the painted boundary conditions.
[[nodiscard]] bool names_boundary(const nlohmann::json& plan);

/// Whether a plan that passed check_files_of_plan() keeps the canals of the nerves free.
/// \param text  of the plan.
[[nodiscard]] bool names_canals(const std::string& text);

/// \param text  of a plan.
/// \returns nothing, or kPlanInvalid if the plan is not an object with segments, or names a file
///   that a case does not have.
[[nodiscard]] Result<void> check_files_of_plan(const std::string& text);

}  // namespace lefort::server
