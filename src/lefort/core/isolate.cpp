#include <lefort/core/isolate.h>

#include <tbb/task_arena.h>

namespace lefort {

void isolate(const std::function<void()>& body) {
#ifdef __SANITIZE_THREAD__
  body();  // Loops are not TBB's then (thread_loop.h): whoever waits begins nothing else.
#else
  tbb::this_task_arena::isolate(body);
#endif
}

}  // namespace lefort
