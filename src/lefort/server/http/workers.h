/// \file
/// Threads that serve connections: so many, and who is slow makes room for who is not.
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

/// Those that wait for a thread are ended when there are too many; one that holds a thread without
/// asking makes room.
class Workers final : public httplib::TaskQueue {
 public:
  /// \param limits  outlive this.
  explicit Workers(const HttpLimits& limits);

  void enqueue(std::function<void()> task) override;
  void shutdown() override;

  /// Connections that may be ended. Those that leave are not touched any more.
  void enter(const Connection* connection);
  void leave(const Connection* connection);

  /// Whether the present thread shall say good-bye to its connection at once.
  [[nodiscard]] static bool is_rejecting();

 private:
  void work();
  void evict_idle();

  const HttpLimits& limits_;
  std::mutex mutex_;
  std::condition_variable wake_, wake_evictor_;
  std::deque<std::function<void()>> tasks_;
  std::set<const Connection*> connections_;
  int idle_ = 0;
  bool is_ending_ = false;
  std::vector<std::thread> threads_;
  std::thread evictor_;
};

}  // namespace lefort::server
