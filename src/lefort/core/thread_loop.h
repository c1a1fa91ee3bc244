/// \file
/// A parallel loop for builds with the thread sanitizer.
///
/// The sanitizer recognizes only synchronization in code that was compiled with it. Debian's TBB
/// was not: every TBB loop would be reported as a race, and suppressing these reports would hide
/// true races. In those builds parallel.h uses this loop, which starts and joins its own threads;
/// every reported race is then a race in lefort.
#pragma once

#include <lefort/core/types.h>

#include <functional>

namespace lefort {

/// Calls body(i) for every i in [0, count), in any order. Loops nested deeper than two run on one
/// thread.
///
/// \param count    > 0.
/// \param threads  maximum number of threads, > 0.
/// \param body     called concurrently.
/// \throws one of the exceptions that bodies throw.
void thread_loop(Index count, int threads, const std::function<void(Index)>& body);

}  // namespace lefort
