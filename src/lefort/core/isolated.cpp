#include <lefort/core/isolated.h>

#include <tbb/task_arena.h>

namespace lefort {

void isolated(const std::function<void()>& body) { tbb::this_task_arena::isolate(body); }

}  // namespace lefort
