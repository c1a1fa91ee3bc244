/// \file
/// Assertions against our own mistakes. No input file can reach one; errors in data are Results
/// (error.h).
#pragma once

#include <stdexcept>
#include <string>

namespace lefort {

/// A broken promise inside lefort: a bug to be reported, never a property of the input.
class LogicError : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

[[noreturn]] inline void throw_logic_error(const char* condition, const char* file, int line) {
  throw LogicError(std::string(file) + ":" + std::to_string(line) + ": " + condition +
                   " does not hold; this is a bug in lefort");
}

}  // namespace lefort

/// Always armed.
#define LEFORT_CHECK(condition) \
  ((condition) ? void() : ::lefort::throw_logic_error(#condition, __FILE__, __LINE__))

/// For inner loops: armed in debug builds.
#ifdef NDEBUG
#define LEFORT_ASSERT(condition) static_cast<void>(sizeof(!(condition)))
#else
#define LEFORT_ASSERT(condition) LEFORT_CHECK(condition)
#endif
