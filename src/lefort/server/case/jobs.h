/// \file
/// Queue of jobs, one running at a time. Jobs can be cancelled and are recorded on disk.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/server/case/event_log.h>

#include <nlohmann/json.hpp>

#include <atomic>
#include <condition_variable>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

namespace lefort::server {

/// Record of a job (contract/openapi.json, Job).
struct JobRecord {
  int id = 0;
  std::string kind;
  nlohmann::json parameters = nlohmann::json::object();
  std::string state;      ///< "queued", "running", "done", "failed", "cancelled", "interrupted".
  std::string stage;      ///< Name of the current stage.
  double fraction = 0.0;  ///< Fraction of the stage that is done, 0 to 1.
  std::deque<std::string> lines;  ///< The last notes.
  std::string message;            ///< Result, in one or more lines, or error, in one line.
  nlohmann::json result;
  std::optional<bool> has_findings;
  std::string created, ended;  ///< UTC, ISO 8601; `ended` is empty until the job ends.

  [[nodiscard]] bool is_over() const { return state != "queued" && state != "running"; }
};

/// The time in UTC, ISO 8601 to the second.
[[nodiscard]] std::string utc_now();

[[nodiscard]] nlohmann::json as_json(const JobRecord& job);

/// Result of a finished job.
struct JobOutcome {
  std::string message;
  nlohmann::json result = nlohmann::json::object();
  std::optional<bool> has_findings = std::nullopt;
};

/// Thread-safe.
class Jobs {
 public:
  /// Runs a job, on the worker thread.
  using Work = std::function<Result<JobOutcome>(const JobRecord& job, Progress& progress)>;
  /// Called, on any thread, when a job was queued, started, ended, or requested to stop.
  using Changed = std::function<void()>;

  /// Reads the records of earlier servers; jobs that had not ended become `interrupted`.
  Jobs(std::filesystem::path folder, EventLog& events, Work work, Changed changed);
  ~Jobs();
  Jobs(const Jobs&) = delete;
  Jobs& operator=(const Jobs&) = delete;

  /// \returns the queued job; kInvalidArgument if the queue is full.
  [[nodiscard]] Result<JobRecord> submit(std::string kind, nlohmann::json parameters);

  [[nodiscard]] std::vector<JobRecord> all() const;
  [[nodiscard]] std::optional<JobRecord> find(int id) const;
  /// The last job that `is_wanted` accepts, if there was one.
  [[nodiscard]] std::optional<JobRecord> last_of(
      const std::function<bool(const JobRecord&)>& is_wanted) const;
  [[nodiscard]] bool is_idle() const;

  /// Requests a running job to stop and cancels a queued one; a job that has ended is unchanged.
  ///
  /// \returns the job; nothing if it does not exist.
  [[nodiscard]] std::optional<JobRecord> cancel(int id);

  /// Stops the running job. The next server reports this job and the queued ones as interrupted.
  void stop();

 private:
  class Listener;
  void work_on();
  void report_change() const;
  void keep(const JobRecord& job) const;
  void notify(const JobRecord& job, const std::optional<std::string>& line = std::nullopt);

  const std::filesystem::path folder_;
  EventLog& events_;
  const Work work_;
  const Changed changed_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::map<int, JobRecord> jobs_;
  std::deque<int> queue_;
  int running_ = 0;
  std::atomic<bool> stop_running_ = false;
  bool is_ending_ = false;
  std::thread worker_;
};

}  // namespace lefort::server
