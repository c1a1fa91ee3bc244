/// \file
/// Assertions for programming errors. No input can violate an assertion; errors in data are Results
/// (error.h).
#pragma once

#include <stdexcept>
#include <string>

namespace lefort {

/// An assertion failed: a bug in lefort, never a property of the input.
class LogicError : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

[[noreturn]] inline void throw_logic_error(const char* condition, const char* file, int line) {
  throw LogicError(std::string(file) + ":" + std::to_string(line) + ": " + condition +
                   " does not hold; this is a bug in lefort");
}

}  // namespace lefort

/// Checked in every build.
#define LEFORT_CHECK(condition) \
  ((condition) ? void() : ::lefort::throw_logic_error(#condition, __FILE__, __LINE__))

/// For inner loops: checked in debug builds only.
#ifdef NDEBUG
#define LEFORT_ASSERT(condition) static_cast<void>(sizeof(!(condition)))
#else
#define LEFORT_ASSERT(condition) LEFORT_CHECK(condition)
#endif
