/// \file
/// A plain parallel loop for builds with the thread sanitizer.
///
/// The sanitizer sees only how code synchronises that was built with it. Debian's TBB was not:
/// every loop would look like a race, and if that were overlooked, so would be the true ones.
/// Threads that are started and joined here it sees; so in those builds parallel.h loops by them,
/// and any race it reports is lefort's own.
#pragma once

#include <lefort/core/types.h>

#include <functional>

namespace lefort {

/// Calls body(i) for every i of [0, count), in any order, on at most `threads` threads; loops
/// deeper than two within each other run on one.
///
/// \throws what a body throws; of several, one.
/// \pre count > 0, threads > 0.
void thread_loop(Index count, int threads, const std::function<void(Index)>& body);

}  // namespace lefort
