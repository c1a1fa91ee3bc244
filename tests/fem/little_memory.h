/// \file
/// A machine whose memory is used up, for the linear solver alone.
#pragma once

#include <suitesparse/SuiteSparse_config.h>

#include <cstddef>

namespace lefort::test {

/// While it lives, CHOLMOD is refused all memory it asks for.
class LittleMemory {
 public:
  LittleMemory() {
    SuiteSparse_config.malloc_func = [](std::size_t) -> void* { return nullptr; };
    SuiteSparse_config.calloc_func = [](std::size_t, std::size_t) -> void* { return nullptr; };
    SuiteSparse_config.realloc_func = [](void*, std::size_t) -> void* { return nullptr; };
  }
  ~LittleMemory() { SuiteSparse_config = usual_; }
  LittleMemory(const LittleMemory&) = delete;
  LittleMemory& operator=(const LittleMemory&) = delete;

 private:
  SuiteSparse_config_struct usual_ = SuiteSparse_config;
};

}  // namespace lefort::test
