/// \file
/// Nested parallel loops.
#pragma once

#include <functional>

namespace lefort {

/// Runs body(). While a thread waits for a parallel loop inside body(), it executes no iterations
/// of loops outside. They may be long and would delay the code after the inner loop.
///
/// \param body  is called once, in the calling thread.
void isolate(const std::function<void()>& body);

}  // namespace lefort
