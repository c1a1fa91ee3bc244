#include <lefort/server/case/event_batcher.h>

#include <utility>

namespace lefort::server {

void EventBatcher::add(nlohmann::json iterate, Clock::time_point now) {
  pending_.push_back(std::move(iterate));
  if (last_report_ == Clock::time_point::min() || now - last_report_ >= kPause) flush(now);
}

void EventBatcher::flush(Clock::time_point now) {
  if (pending_.empty()) return;
  last_report_ = now;
  report_(std::exchange(pending_, nlohmann::json::array()));
}

}  // namespace lefort::server
