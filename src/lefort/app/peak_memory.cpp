#include <lefort/app/peak_memory.h>

#include <sys/resource.h>

namespace lefort::app {

double peak_memory_mb() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return double(usage.ru_maxrss) / 1024.0;  // Linux counts kilobytes.
}

}  // namespace lefort::app
