/// \file
/// How a function says that the data or the problem, not our code, is at fault.
///
/// A message is one lower-case sentence without full stop: the object, the value found, the value
/// wanted. Bugs of our own are LEFORT_CHECK (check.h).
#pragma once

#include <tl/expected.hpp>

#include <string>
#include <utility>

namespace lefort {

enum class ErrorCode {
  kInvalidArgument,  ///< An option or parameter lies outside its range.
  kFileNotFound,     ///< An input does not exist.
  kFileCorrupt,      ///< An input is truncated, damaged or contradicts itself.
  kFileUnsupported,  ///< An input is of a kind we do not read.
  kFileUnwritable,   ///< An output could not be written: permission, disk full.
  kPlanInvalid,      ///< The plan breaks its schema or contradicts itself.
  kMeshInvalid,      ///< A surface is empty, open, or not orientable where it must be.
  kAnatomyMissing,   ///< A tissue that is needed is not in the scan.
  kCutMissesBone,    ///< An osteotomy does not split the bone in two.
  kMeshingFailed,    ///< No usable volume mesh came out.
  kElementInverted,  ///< An element has no positive volume.
  kStepBeyondBand,   ///< A bone moves further in a step than its distance field can tell.
  kNotConverged,     ///< The solver found no equilibrium.
  kCancelled,        ///< The user asked to stop.
  kOutOfMemory,      ///< The problem is larger than the memory of this machine.

  kAccessDenied,      ///< A server rejects the user name or password.
  kConnectionFailed,  ///< A server cannot be reached or trusted, or the connection was lost.
};

struct Error {
  ErrorCode code;
  std::string message;
};

template <class T>
using Result = tl::expected<T, Error>;

[[nodiscard]] inline tl::unexpected<Error> fail(ErrorCode code, std::string message) {
  return tl::unexpected<Error>(Error{code, std::move(message)});
}

}  // namespace lefort

#define LEFORT_CONCAT_INNER(a, b) a##b
#define LEFORT_CONCAT(a, b) LEFORT_CONCAT_INNER(a, b)
#define LEFORT_TRY_INNER(result, declaration, expression)        \
  auto result = (expression);                                    \
  if (!result) return tl::unexpected(std::move(result).error()); \
  declaration = *std::move(result)

/// LEFORT_TRY(const auto x, f()); gives x its value, or returns f's error from this function.
#define LEFORT_TRY(declaration, ...) \
  LEFORT_TRY_INNER(LEFORT_CONCAT(lefort_try_, __LINE__), declaration, (__VA_ARGS__))

/// LEFORT_TRY_VOID(f()); returns f's error from this function, if it has one.
#define LEFORT_TRY_VOID(...)                                     \
  do {                                                           \
    if (auto lefort_try_void = (__VA_ARGS__); !lefort_try_void)  \
      return tl::unexpected(std::move(lefort_try_void).error()); \
  } while (false)
