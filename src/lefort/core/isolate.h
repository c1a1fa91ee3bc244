/// \file
/// Parallel loops within parallel loops.
#pragma once

#include <functional>

namespace lefort {

/// Runs body(). While a loop in it waits for its last pieces, its thread does not begin pieces of
/// loops outside: they may be long, and what follows the body would wait for them.
void isolate(const std::function<void()>& body);

}  // namespace lefort
