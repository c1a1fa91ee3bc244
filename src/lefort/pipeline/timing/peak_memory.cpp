#include <lefort/pipeline/timing/peak_memory.h>

#include <sys/resource.h>

namespace lefort::pipeline {

double peak_memory_mb() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return double(usage.ru_maxrss) * 1024.0 / 1e6;  // Linux counts in 1024 bytes.
}

}  // namespace lefort::pipeline
