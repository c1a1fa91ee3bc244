#include <lefort/server/case/solve_history.h>

#include <utility>

namespace lefort::server {

using nlohmann::json;

void SolveHistory::begin(int job) {
  const std::scoped_lock lock(mutex_);
  job_ = job;
  removed_ = 0;
  iterates_.clear();
  steps_ = json::array();
}

std::size_t SolveHistory::add_iterates(const json& iterates) {
  const std::scoped_lock lock(mutex_);
  const std::size_t before = removed_ + iterates_.size();
  iterates_.insert(iterates_.end(), iterates.begin(), iterates.end());
  for (; iterates_.size() > kMaxIterates; ++removed_) iterates_.pop_front();
  return before;
}

void SolveHistory::add_step(json step) {
  const std::scoped_lock lock(mutex_);
  steps_.push_back(std::move(step));
}

std::optional<json> SolveHistory::of(int job) const {
  const std::scoped_lock lock(mutex_);
  if (job != job_) return std::nullopt;
  return json{{"job", job_}, {"from", removed_}, {"iterates", iterates_}, {"steps", steps_}};
}

}  // namespace lefort::server
