#include <lefort/core/isolate.h>

#include <tbb/task_arena.h>

namespace lefort {

void isolate(const std::function<void()>& body) {
#ifdef __SANITIZE_THREAD__
  body();  // thread_loop.h does not use TBB: a waiting thread runs nothing else.
#else
  tbb::this_task_arena::isolate(body);
#endif
}

}  // namespace lefort
