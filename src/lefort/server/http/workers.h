/// \file
/// Pool of threads that serve connections, with eviction of slow ones.
#pragma once

#include <lefort/server/http/connection.h>
#include <lefort/server/http/http_server.h>

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <set>
#include <thread>
#include <vector>

namespace lefort::server {

/// New connections are rejected when too many wait for a thread. While connections wait, one that
/// occupies a thread without a complete request header, or does not read its response, is evicted.
class Workers final : public httplib::TaskQueue {
 public:
  /// \param limits  must outlive this object.
  explicit Workers(const HttpLimits& limits);

  void enqueue(std::function<void()> task) override;
  void shutdown() override;

  /// Registers a connection that can be evicted until leave().
  void enter(const Connection* connection);
  void leave(const Connection* connection);

  /// Whether the current thread must reject its connection.
  [[nodiscard]] static bool is_rejecting();

 private:
  void work();
  void evict_slow_connections();

  const HttpLimits& limits_;
  std::mutex mutex_;
  std::condition_variable wake_, wake_evictor_;
  std::deque<std::function<void()>> tasks_;
  std::set<const Connection*> connections_;
  int idle_threads_ = 0;
  bool is_ending_ = false;
  std::vector<std::thread> threads_;
  std::thread evictor_;
};

}  // namespace lefort::server
