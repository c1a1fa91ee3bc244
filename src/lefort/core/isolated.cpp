#include <lefort/core/isolated.h>

#include <tbb/task_arena.h>

namespace lefort {

void isolated(const std::function<void()>& body) {
#ifdef __SANITIZE_THREAD__
  body();  // Loops are not TBB's then (loop_by_threads.h): whoever waits begins nothing else.
#else
  tbb::this_task_arena::isolate(body);
#endif
}

}  // namespace lefort
