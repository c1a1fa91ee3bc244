/// \file
/// Nested parallel loops.
#pragma once

#include <functional>

namespace lefort {

/// Calls body(). While the thread waits for a parallel loop inside body(), it executes no iteration
/// of a loop outside body(): such an iteration might take long and delay the code after the inner
/// loop.
///
/// \param body  is called once, in the calling thread.
void isolate(const std::function<void()>& body);

}  // namespace lefort
