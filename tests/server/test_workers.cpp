#include <lefort/server/http/workers.h>

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <future>
#include <thread>

namespace lefort::server::test_workers {
namespace {

using std::chrono::milliseconds;

/// A client that connects and sends nothing.
class SilentClient {
 public:
  SilentClient() { EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends_), 0); }
  ~SilentClient() {
    ::close(ends_[0]);
    ::close(ends_[1]);
  }
  SilentClient(const SilentClient&) = delete;
  SilentClient& operator=(const SilentClient&) = delete;

  [[nodiscard]] int served_end() const { return ends_[0]; }

 private:
  int ends_[2];
};

// Both tasks are in the queue before the idle thread wakes up: the thread that evicts must notice
// that the second one waits.
TEST(Workers, EvictASilentClientForATaskAddedWhileAThreadWasIdle) {
  HttpLimits limits;
  limits.threads = 1;
  limits.idle_time = milliseconds(60'000);
  limits.eviction_timeout = milliseconds(5);
  for (int n = 0; n < 20; ++n) {
    const SilentClient client;
    Workers workers(limits);
    std::this_thread::sleep_for(milliseconds(2));
    std::promise<void> is_served;
    workers.enqueue([&] {
      Connection connection(client.served_end(), limits);
      workers.enter(&connection);
      static_cast<void>(connection.wait_for_request());
      workers.leave(&connection);
    });
    workers.enqueue([&] { is_served.set_value(); });
    const auto status = is_served.get_future().wait_for(limits.idle_time / 3);
    workers.shutdown();
    ASSERT_EQ(status, std::future_status::ready) << "repetition " << n;
  }
}

}  // namespace
}  // namespace lefort::server::test_workers
