#include <lefort/server/case/iterate_batches.h>

#include <utility>

namespace lefort::server {

void IterateBatches::add(nlohmann::json iterate, Clock::time_point now) {
  waiting_.push_back(std::move(iterate));
  if (told_ == Clock::time_point::min() || now - told_ >= kPause) flush(now);
}

void IterateBatches::flush(Clock::time_point now) {
  if (waiting_.empty()) return;
  told_ = now;
  tell_(std::exchange(waiting_, nlohmann::json::array()));
}

}  // namespace lefort::server
