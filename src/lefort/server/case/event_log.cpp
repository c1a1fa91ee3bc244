#include <lefort/server/case/event_log.h>

#include <fmt/format.h>

#include <charconv>
#include <utility>

namespace lefort::server {
namespace {

constexpr std::size_t kMaxEvents = 4000;  // A real case's solve has some 500.
constexpr std::size_t kMaxBytes = 4 << 20;

}  // namespace

EventLog::EventLog(std::string start) : start_(std::move(start)) {}

void EventLog::publish(std::string_view type, const nlohmann::json& data) {
  const std::string text = data.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  const std::scoped_lock lock(mutex_);
  ++last_;
  texts_.push_back(fmt::format("id: {}.{}\nevent: {}\ndata: {}\n\n", start_, last_, type, text));
  bytes_ += texts_.back().size();
  while (texts_.size() > kMaxEvents || (bytes_ > kMaxBytes && texts_.size() > 1)) {
    bytes_ -= texts_.front().size();
    texts_.pop_front();
  }
  more_.notify_all();
}

std::uint64_t EventLog::now() const {
  const std::scoped_lock lock(mutex_);
  return last_;
}

std::optional<std::uint64_t> EventLog::find(std::string_view id) const {
  if (!id.starts_with(start_ + ".")) return std::nullopt;
  id.remove_prefix(start_.size() + 1);
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(id.data(), id.data() + id.size(), number);
  if (error != std::errc() || end != id.data() + id.size()) return std::nullopt;
  const std::scoped_lock lock(mutex_);
  if (number > last_ || number + texts_.size() < last_) return std::nullopt;
  return number;
}

std::string EventLog::wait(std::uint64_t& heard, std::chrono::milliseconds longest) {
  std::unique_lock lock(mutex_);
  more_.wait_for(lock, longest, [&] { return is_stopped_ || last_ > heard; });
  std::string text;
  if (heard + texts_.size() < last_) {  // Removed from the log meanwhile.
    heard = last_;
    return reset_event_at(last_);
  }
  for (; heard < last_; ++heard) text += texts_[std::size_t(heard - (last_ - texts_.size()))];
  return text;
}

std::string EventLog::reset_event() const { return reset_event_at(now()); }

std::string EventLog::reset_event_at(std::uint64_t number) const {
  return fmt::format("id: {}.{}\nevent: reset\ndata: {{\"start\":\"{}\"}}\n\n", start_, number,
                     start_);
}

void EventLog::stop() {
  const std::scoped_lock lock(mutex_);
  is_stopped_ = true;
  more_.notify_all();
}

bool EventLog::is_stopped() const {
  const std::scoped_lock lock(mutex_);
  return is_stopped_;
}

}  // namespace lefort::server
