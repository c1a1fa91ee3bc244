#include <lefort/server/http/workers.h>

#include <exception>
#include <utility>

namespace lefort::server {
namespace {

thread_local bool is_sending_away = false;

}  // namespace

Workers::Workers(const HttpLimits& limits) : limits_(limits) {
  for (int n = 0; n < limits.threads; ++n) threads_.emplace_back([this] { work(); });
  evictor_ = std::thread([this] { evict_slow_connections(); });
}

bool Workers::is_rejecting() { return is_sending_away; }

void Workers::enqueue(std::function<void()> task) {
  {
    const std::scoped_lock lock(mutex_);
    if (tasks_.size() < std::size_t(limits_.waiting)) {
      tasks_.push_back(std::move(task));
      task = nullptr;
    }
  }
  if (task) {  // The queue is full: rejected on the accepting thread.
    is_sending_away = true;
    task();
    is_sending_away = false;
    return;
  }
  wake_.notify_one();
  wake_evictor_.notify_one();
}

void Workers::shutdown() {
  {
    const std::scoped_lock lock(mutex_);
    is_ending_ = true;
    for (const Connection* connection : connections_) connection->abort();
  }
  wake_.notify_all();
  wake_evictor_.notify_all();
  for (std::thread& thread : threads_) thread.join();
  evictor_.join();
}

void Workers::enter(const Connection* connection) {
  const std::scoped_lock lock(mutex_);
  connections_.insert(connection);
  if (is_ending_) connection->abort();
}

void Workers::leave(const Connection* connection) {
  const std::scoped_lock lock(mutex_);
  connections_.erase(connection);
}

void Workers::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    ++idle_threads_;
    wake_.wait(lock, [&] { return is_ending_ || !tasks_.empty(); });
    --idle_threads_;
    if (tasks_.empty()) return;
    const std::function<void()> task = std::move(tasks_.front());
    tasks_.pop_front();
    // The evictor may have seen this thread idle when the tasks that still wait were added.
    if (idle_threads_ == 0 && !tasks_.empty()) wake_evictor_.notify_one();
    is_sending_away = is_ending_;
    lock.unlock();
    try {
      task();
    } catch (const std::exception&) {  // Out of memory: this connection ends, not the server.
    }
    lock.lock();
  }
}

/// Evicts slow connections while others wait.
void Workers::evict_slow_connections() {
  std::unique_lock lock(mutex_);
  while (!is_ending_) {
    if (tasks_.empty() || idle_threads_ > 0) {
      wake_evictor_.wait(lock,
                         [&] { return is_ending_ || (!tasks_.empty() && idle_threads_ == 0); });
      continue;
    }
    const auto too_long_ago = Connection::Clock::now() - limits_.eviction_timeout;
    for (const Connection* connection : connections_)
      if (connection->is_waiting() && connection->since() < too_long_ago) connection->abort();
    wake_evictor_.wait_for(lock, limits_.eviction_timeout);
  }
}

}  // namespace lefort::server
