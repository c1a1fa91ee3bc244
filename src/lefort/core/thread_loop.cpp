#include <lefort/core/thread_loop.h>

#include <algorithm>
#include <exception>
#include <thread>
#include <vector>

namespace lefort {
namespace {

constexpr int kMaxNested = 2;
thread_local int nested = 0;

}  // namespace

void thread_loop(Index count, int threads, const std::function<void(Index)>& body) {
  const int depth = nested + 1;
  const Index team_size = depth > kMaxNested ? 1 : std::clamp<Index>(threads, 1, count);
  std::vector<std::exception_ptr> thrown(static_cast<std::size_t>(team_size));
  // Iterations are assigned to threads in advance. Otherwise one thread might run all of them, and
  // no race could be detected.
  const auto work = [&](Index member) {
    nested = depth;
    try {
      for (Index i = member; i < count; i += team_size) body(i);
    } catch (...) {
      thrown[std::size_t(member)] = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> others;
    for (Index member = 1; member < team_size; ++member) others.emplace_back(work, member);
    work(0);
  }
  nested = depth - 1;
  for (const std::exception_ptr& one : thrown)
    if (one) std::rethrow_exception(one);
}

}  // namespace lefort
