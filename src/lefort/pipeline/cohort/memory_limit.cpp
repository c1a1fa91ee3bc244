#include <lefort/core/parallel.h>
#include <lefort/pipeline/cohort/memory_limit.h>

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace lefort::pipeline {

namespace {

constexpr double kGigabyte = 1e9;

}  // namespace

double machine_memory_gb() {
  return double(::sysconf(_SC_PHYS_PAGES)) * double(::sysconf(_SC_PAGE_SIZE)) / kGigabyte;
}

Result<void> limit_memory(double memory_gb) {
  const double machine_gb = machine_memory_gb();
  if (memory_gb > machine_gb)
    return fail(ErrorCode::kOutOfMemory,
                fmt::format("--mem-gb is {:g}, this machine has {:.1f} GB: give less", memory_gb,
                            machine_gb));
  // Starts the threads of parallel loops: their stacks could not be allocated later.
  parallel_for(1 << 20, [](Index) {});
  rlimit limit{};
  ::getrlimit(RLIMIT_DATA, &limit);
  limit.rlim_cur = rlim_t(memory_gb * kGigabyte);
  if (limit.rlim_cur > limit.rlim_max) limit.rlim_cur = limit.rlim_max;
  if (::setrlimit(RLIMIT_DATA, &limit) == 0) return {};
  return fail(ErrorCode::kInvalidArgument,
              fmt::format("--mem-gb cannot be set: {}", std::strerror(errno)));
}

}  // namespace lefort::pipeline
