/// \file
/// The folder of one case: where everything of it lies, and what of it matches its inputs.
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

/// What a plan of a case calls the boundary that was painted.
inline constexpr const char* kBoundaryFile = "boundary.seg.nrrd";

/// A folder that no other server uses while this lives. Safe from many threads.
class CaseFolder {
 public:
  /// Makes the folder if it is missing, for its owner alone; ends with its uploads.
  ///
  /// \returns kFileUnwritable: it cannot be made or written, or another server has it.
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
  /// What was painted on the tissue's boundary; a plan names it so.
  [[nodiscard]] std::filesystem::path boundary() const { return root_ / kBoundaryFile; }
  [[nodiscard]] std::filesystem::path cut() const { return root_ / "cut"; }
  [[nodiscard]] std::filesystem::path check() const { return root_ / "check"; }
  [[nodiscard]] std::filesystem::path preview() const { return root_ / "preview"; }
  [[nodiscard]] std::filesystem::path prediction() const { return root_ / "prediction"; }
  [[nodiscard]] std::filesystem::path comparison() const { return root_ / "comparison"; }
  /// What stages share: labels, fields, the tissue's mesh.
  [[nodiscard]] std::filesystem::path cache() const { return prediction() / "cache"; }
  [[nodiscard]] std::filesystem::path jobs() const { return root_ / "jobs"; }
  [[nodiscard]] std::filesystem::path uploads() const { return root_ / "uploads"; }

  /// SHA-256 of a file, remembered while it stays the same by stat(); nothing if it is not there.
  [[nodiscard]] std::optional<std::string> fingerprint(const std::filesystem::path& file) const;

  /// As an entity tag, in quotes.
  [[nodiscard]] std::optional<std::string> etag(const std::filesystem::path& file) const;

  /// Everything a stage was made of, by name, as fingerprints.
  using Inputs = std::map<std::string, std::string>;

  /// Of what a stage is made now. Nothing where an input is missing.
  ///
  /// \param stage  "anatomy", "cut", "check", "preview", "prediction", "comparison".
  [[nodiscard]] std::optional<Inputs> inputs_of(std::string_view stage) const;

  /// Remembers of what a stage was made.
  [[nodiscard]] Result<void> record_inputs(std::string_view stage, const Inputs& inputs);

  /// Removes the documents by which a stage is known to be made, so that none of an earlier job
  /// passes for one of the inputs that are remembered next.
  ///
  /// \param stage  "cut", "check", "preview", "prediction"; of others nothing is removed.
  [[nodiscard]] Result<void> forget_result(std::string_view stage) const;

  /// Whether what is there matches its inputs: contract/openapi.json, Stage, but for jobs.
  [[nodiscard]] nlohmann::json stage(std::string_view stage) const;

 private:
  explicit CaseFolder(std::filesystem::path root, int lock);

  /// By what a file is known to be the same: a time alone can be set back, or be too coarse.
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

/// Bytes of a document of ours that is read; prediction.json is some MB.
inline constexpr std::uintmax_t kMaxDocument = 256 << 20;

/// Whether there is a regular file of that name.
[[nodiscard]] bool there_is(const std::filesystem::path& file);

/// The object that a file of ours holds; an empty one if it is not there or damaged.
[[nodiscard]] nlohmann::json read_object(const std::filesystem::path& file);

/// The stages of a case, in order.
inline constexpr const char* kStages[] = {"scan",       "anatomy",   "landmarks", "plan",
                                          "boundary",   "cut",       "check",     "preview",
                                          "prediction", "comparison"};

/// Whether a plan, JSON that check_files_of_plan() has passed, names what was painted.
[[nodiscard]] bool names_boundary(const nlohmann::json& plan);

/// Nothing, or kPlanInvalid: whether a plan, JSON of an object, names no file but those a case has.
[[nodiscard]] Result<void> check_files_of_plan(const std::string& text);

}  // namespace lefort::server
