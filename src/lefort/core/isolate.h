/// \file
/// Nested parallel loops.
#pragma once

#include <functional>

namespace lefort {

/// Runs body(). A thread that waits for the end of a parallel loop in it does not execute
/// iterations of outer loops meanwhile: they may be long, and would delay the code after the inner
/// loop.
///
/// \param body  is called once, in the calling thread.
void isolate(const std::function<void()>& body);

}  // namespace lefort
