/// \file
/// Errors in the data or the problem, returned as values.
///
/// A message is one lower-case sentence without a full stop: the object, the value found, the value
/// required. Programming errors are LEFORT_CHECK (check.h).
#pragma once

#include <tl/expected.hpp>

#include <string>
#include <utility>

namespace lefort {

/// Kinds of errors.
enum class ErrorCode {
  kInvalidArgument,  ///< An option or parameter lies outside its range.
  kFileNotFound,     ///< An input does not exist.
  kFileCorrupt,      ///< An input is truncated, damaged or inconsistent.
  kFileUnsupported,  ///< The format of an input is not supported.
  kFileUnwritable,   ///< An output could not be written: permission, disk full.
  kPlanInvalid,      ///< The plan violates its schema or is inconsistent.
  kMeshInvalid,      ///< A surface or volume mesh is invalid, for example empty or not closed.
  kAnatomyMissing,   ///< A required tissue or part of the anatomy was not found.
  kCutMissesBone,    ///< An osteotomy does not divide the bone.
  kMeshingFailed,    ///< No valid volume mesh was generated.
  kElementInverted,  ///< An element is degenerate or inverted.
  kStepBeyondBand,   ///< A bone moves further in one step than its distance band covers.
  kNotConverged,     ///< The solver found no equilibrium.
  kCancelled,        ///< The user asked to stop.
  kOutOfMemory,      ///< The problem needs more memory than available or allowed.

  kAccessDenied,      ///< A server rejects the user name or password.
  kConnectionFailed,  ///< A server cannot be reached or trusted, or the connection was lost.
};

/// An error of the data or the problem.
struct Error {
  ErrorCode code;
  std::string message;
};

/// A value, or the error that prevented it.
template <class T>
using Result = tl::expected<T, Error>;

/// The error as a return value.
///
/// \param code     kind of the error.
/// \param message  as described at the top of this file.
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

/// LEFORT_TRY(const auto x, f()); initializes x with the value of f(), or returns its error. It
/// expands to several statements: a branch of an `if` needs braces around it.
#define LEFORT_TRY(declaration, ...) \
  LEFORT_TRY_INNER(LEFORT_CONCAT(lefort_try_, __LINE__), declaration, (__VA_ARGS__))

/// LEFORT_TRY_VOID(f()); returns the error of f(), if there is one.
#define LEFORT_TRY_VOID(...)                                     \
  do {                                                           \
    if (auto lefort_try_void = (__VA_ARGS__); !lefort_try_void)  \
      return tl::unexpected(std::move(lefort_try_void).error()); \
  } while (false)
