/// \file
/// Docstrings from the comments of the C++ headers.
#pragma once

#include <lefort_docs.h>

#include <string_view>

namespace lefort::python {

/// \param name  of a declaration, without the namespace lefort. cmake/extract_docs.py finds these
///   calls in the sources; the build fails if the declaration has no comment.
/// \returns its comment.
consteval const char* doc(std::string_view name) {
  for (const Doc& one : kDocs)
    if (one.name == name) return one.text;
  throw "cmake/extract_docs.py found no comment";  // Is a compile error here.
}

}  // namespace lefort::python
