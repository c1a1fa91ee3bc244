#include <lefort/core/parallel.h>

#include <tbb/global_control.h>

namespace lefort {

ThreadLimit::ThreadLimit(int threads) : control_(nullptr) {
  LEFORT_CHECK(threads >= 0);
  if (threads > 0)
    control_ = new tbb::global_control(tbb::global_control::max_allowed_parallelism,
                                       static_cast<std::size_t>(threads));
}

ThreadLimit::~ThreadLimit() { delete static_cast<tbb::global_control*>(control_); }

int ThreadLimit::current() {
  return static_cast<int>(
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

}  // namespace lefort
