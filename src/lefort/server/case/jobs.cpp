#include <lefort/core/check.h>
#include <lefort/core/printable.h>
#include <lefort/io/read_text.h>
#include <lefort/io/write_atomically.h>
#include <lefort/server/case/case_folder.h>
#include <lefort/server/case/jobs.h>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <exception>
#include <utility>

namespace lefort::server {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using Clock = std::chrono::steady_clock;

constexpr int kLastId = 1'000'000'000;  // The next one is still a number of the contract.
constexpr std::size_t kMaxLines = 200;  // As the contract says.
constexpr std::size_t kMaxQueued = 8;
constexpr std::size_t kMaxKept = 100;            // Records on disk; the oldest go.
constexpr std::size_t kLongestLine = 2000;       // Characters.
constexpr std::uintmax_t kMaxRecord = 64 << 20;  // Bytes.
constexpr auto kReportEvery = std::chrono::milliseconds(100);

std::optional<JobRecord> read_record(const fs::path& file) {
  const auto text = io::read_text(file, kMaxRecord);
  if (!text) return std::nullopt;
  const json stored = parse_limited(*text);
  if (!stored.is_object()) return std::nullopt;
  try {
    JobRecord job;
    job.id = stored.at("id").get<int>();
    job.kind = stored.at("kind").get<std::string>();
    job.parameters = stored.at("parameters");
    job.state = stored.at("state").get<std::string>();
    job.stage = stored.at("stage").get<std::string>();
    job.fraction = stored.at("fraction").get<double>();
    job.lines = stored.at("lines").get<std::deque<std::string>>();
    job.message = stored.at("message").get<std::string>();
    job.result = stored.at("result");
    if (stored.contains("has_findings")) job.has_findings = stored["has_findings"].get<bool>();
    job.created = stored.at("created").get<std::string>();
    if (stored.at("ended").is_string()) job.ended = stored["ended"].get<std::string>();
    if (job.id > 0 && job.id <= kLastId && file.filename() == fmt::format("{}.json", job.id))
      return job;
  } catch (const json::exception&) {  // Not a record: ignored.
  }
  return std::nullopt;
}

}  // namespace

std::string utc_now() {
  return fmt::format(
      "{:%Y-%m-%dT%H:%M:%SZ}",
      fmt::gmtime(std::chrono::system_clock::to_time_t(std::chrono::system_clock::now())));
}

json as_json(const JobRecord& job) {
  json result{{"id", job.id},
              {"kind", job.kind},
              {"parameters", job.parameters},
              {"state", job.state},
              {"stage", job.stage},
              {"fraction", job.fraction},
              {"lines", job.lines},
              {"message", job.message},
              {"result", job.result},
              {"created", job.created},
              {"ended", job.ended.empty() ? json() : json(job.ended)}};
  if (job.has_findings) result["has_findings"] = *job.has_findings;
  return result;
}

/// Writes the progress of a job into its record and the event log.
class Jobs::Listener final : public Progress {
 public:
  Listener(Jobs& jobs, int id) : jobs_(jobs), id_(id) {}

  void begin_stage(std::string_view name) override {
    change([&](JobRecord& job) {
      job.stage = name;
      job.fraction = 0.0;
    });
    last_report_ = {};  // The start of a stage is always reported.
  }
  void report(double fraction) override {
    const auto now = Clock::now();
    if (now - last_report_ < kReportEvery) return;
    last_report_ = now;
    change([&](JobRecord& job) { job.fraction = std::clamp(fraction, 0.0, 1.0); });
  }
  void note(std::string_view sentence) override {
    std::string line = printable(sentence.substr(0, kLongestLine));
    change(
        [&](JobRecord& job) {
          job.lines.push_back(line);
          if (job.lines.size() > kMaxLines) job.lines.pop_front();
        },
        line);
  }
  [[nodiscard]] bool stop_requested() const override { return jobs_.stop_running_; }

 private:
  template <class Change>
  void change(const Change& change_job, const std::optional<std::string>& line = std::nullopt) {
    const std::scoped_lock lock(jobs_.mutex_);
    JobRecord& job = jobs_.jobs_.at(id_);
    change_job(job);
    jobs_.notify(job, line);
  }

  Jobs& jobs_;
  int id_;
  Clock::time_point last_report_{};
};

Jobs::Jobs(fs::path folder, EventLog& events, Work work, Changed changed)
    : folder_(std::move(folder)),
      events_(events),
      work_(std::move(work)),
      changed_(std::move(changed)) {
  std::error_code error;
  fs::create_directories(folder_, error);
  for (const auto& entry : fs::directory_iterator(folder_, error))
    if (auto job = read_record(entry.path())) {
      const int id = job->id;
      jobs_.emplace(id, *std::move(job));
    }
  for (auto& [id, job] : jobs_) {
    if (job.is_over()) continue;
    job.state = "interrupted";
    job.message =
        "the server ended before this job was done; the next job of this kind resumes from "
        "its results";
    job.ended = utc_now();
    keep(job);
  }
  worker_ = std::thread([this] { work_on(); });
}

Jobs::~Jobs() { stop(); }

Result<JobRecord> Jobs::submit(std::string kind, json parameters) {
  JobRecord job;
  {
    const std::scoped_lock lock(mutex_);
    if (queue_.size() >= kMaxQueued)
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("the queue is full: {} jobs are waiting", queue_.size()));
    job.id = jobs_.empty() ? 1 : jobs_.rbegin()->first + 1;
    job.kind = std::move(kind);
    job.parameters = std::move(parameters);
    job.state = "queued";
    job.created = utc_now();
    while (jobs_.size() >= kMaxKept && jobs_.begin()->second.is_over()) {
      std::error_code error;
      fs::remove(folder_ / fmt::format("{}.json", jobs_.begin()->first), error);
      jobs_.erase(jobs_.begin());
    }
    jobs_.emplace(job.id, job);
    queue_.push_back(job.id);
    keep(job);
    notify(job);
  }
  wake_.notify_all();
  changed_();
  return job;
}

std::vector<JobRecord> Jobs::all() const {
  const std::scoped_lock lock(mutex_);
  std::vector<JobRecord> list;
  for (const auto& [id, job] : jobs_) list.push_back(job);
  return list;
}

std::optional<JobRecord> Jobs::find(int id) const {
  const std::scoped_lock lock(mutex_);
  const auto found = jobs_.find(id);
  return found == jobs_.end() ? std::nullopt : std::optional(found->second);
}

std::optional<JobRecord> Jobs::last_of(
    const std::function<bool(const JobRecord&)>& is_wanted) const {
  const std::scoped_lock lock(mutex_);
  for (auto job = jobs_.rbegin(); job != jobs_.rend(); ++job)
    if (is_wanted(job->second)) return job->second;
  return std::nullopt;
}

bool Jobs::is_idle() const {
  const std::scoped_lock lock(mutex_);
  return running_ == 0 && queue_.empty();
}

std::optional<JobRecord> Jobs::cancel(int id) {
  std::optional<JobRecord> cancelled;
  {
    const std::scoped_lock lock(mutex_);
    const auto found = jobs_.find(id);
    if (found == jobs_.end()) return std::nullopt;
    JobRecord& job = found->second;
    if (running_ == id) {
      stop_running_ = true;
    } else if (job.state == "queued") {
      std::erase(queue_, id);
      job.state = "cancelled";
      job.message = "cancelled before it started";
      job.ended = utc_now();
      keep(job);
      notify(job);
    }
    cancelled = job;
  }
  changed_();
  return cancelled;
}

void Jobs::stop() {
  {
    const std::scoped_lock lock(mutex_);
    is_ending_ = true;
    stop_running_ = true;
  }
  wake_.notify_all();
  if (worker_.joinable()) worker_.join();
}

void Jobs::keep(const JobRecord& job) const {
  // A job runs even if its record cannot be written; other code reports the folder's errors.
  static_cast<void>(
      io::write_text(folder_ / fmt::format("{}.json", job.id),
                     as_json(job).dump(1, ' ', false, json::error_handler_t::replace) + "\n"));
}

void Jobs::notify(const JobRecord& job, const std::optional<std::string>& line) {
  events_.publish("job", {{"id", job.id},
                          {"kind", job.kind},
                          {"state", job.state},
                          {"stage", job.stage},
                          {"fraction", job.fraction},
                          {"line", line ? json(*line) : json()},
                          {"message", job.message}});
}

/// Runs on the worker thread, which no exception may end.
void Jobs::report_change() const {
  try {
    changed_();
  } catch (const std::exception&) {  // Pages request the state again.
  }
}

void Jobs::work_on() {
  std::unique_lock lock(mutex_);
  while (true) {
    wake_.wait(lock, [&] { return is_ending_ || !queue_.empty(); });
    if (is_ending_) return;  // Queued jobs stay "queued" on disk; the next server reports them.
    const int id = queue_.front();
    queue_.pop_front();
    running_ = id;
    stop_running_ = false;
    jobs_.at(id).state = "running";
    keep(jobs_.at(id));
    notify(jobs_.at(id));
    const JobRecord begun = jobs_.at(id);
    lock.unlock();
    report_change();
    Listener listener(*this, id);
    const Result<JobOutcome> outcome = [&]() -> Result<JobOutcome> {
      try {
        return work_(begun, listener);
      } catch (const std::bad_alloc&) {
        return fail(ErrorCode::kOutOfMemory, "not enough memory");
      } catch (const std::exception&) {  // An exception must not end the server; its message is not
        // for pages.
        return fail(ErrorCode::kInvalidArgument, "internal error");
      }
    }();
    lock.lock();
    running_ = 0;
    JobRecord& job = jobs_.at(id);
    if (is_ending_ && !outcome)
      return;  // Stays "running" on disk, which the next server reads as interrupted.
    job.ended = utc_now();
    if (outcome) {
      job.state = "done";
      job.fraction = 1.0;
      job.message = printable(outcome->message, LineBreaks::kKept);
      job.result = outcome->result;
      job.has_findings = outcome->has_findings;
    } else if (outcome.error().code == ErrorCode::kCancelled) {
      job.state = "cancelled";
      job.message = "cancelled";
    } else {
      job.state = "failed";
      job.message = printable(outcome.error().message);
    }
    keep(job);
    notify(job);
    lock.unlock();
    report_change();
    lock.lock();
  }
}

}  // namespace lefort::server
