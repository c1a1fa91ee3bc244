#include <lefort/io/internal/reader_sandbox.h>

#include <fcntl.h>
#include <sched.h>
#include <seccomp.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <fstream>
#include <memory>

namespace lefort::io {

namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kHasFilter = false;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
constexpr bool kHasFilter = false;
#else
constexpr bool kHasFilter = true;
#endif
#else
constexpr bool kHasFilter = true;
#endif

/// System calls of a computation on open files. sched_getaffinity: malloc() counts the processors
/// when memory is short. dup, close and fcntl: zlib.
constexpr int kAllowed[] = {
    SCMP_SYS(read),      SCMP_SYS(readv),         SCMP_SYS(pread64),
    SCMP_SYS(lseek),     SCMP_SYS(fstat),         SCMP_SYS(munmap),
    SCMP_SYS(mremap),    SCMP_SYS(brk),           SCMP_SYS(madvise),
    SCMP_SYS(futex),     SCMP_SYS(write),         SCMP_SYS(writev),
    SCMP_SYS(pwrite64),  SCMP_SYS(dup),           SCMP_SYS(close),
    SCMP_SYS(fcntl),     SCMP_SYS(clock_gettime), SCMP_SYS(sched_getaffinity),
    SCMP_SYS(exit),      SCMP_SYS(exit_group),    SCMP_SYS(restart_syscall),
    SCMP_SYS(getrandom), SCMP_SYS(rt_sigreturn),  SCMP_SYS(sched_yield),
};
/// These fail with EACCES and do not end the process: OpenJPEG, for example, counts the processors
/// by a file of /sys.
constexpr int kRefused[] = {
    SCMP_SYS(open),  SCMP_SYS(openat), SCMP_SYS(access),     SCMP_SYS(faccessat),
    SCMP_SYS(stat),  SCMP_SYS(lstat),  SCMP_SYS(faccessat2), SCMP_SYS(readlink),
    SCMP_SYS(statx), SCMP_SYS(ioctl),  SCMP_SYS(readlinkat), SCMP_SYS(getcwd),
};

/// Sets a limit; one that is lower already, as of `ulimit`, remains unless this user may raise it.
bool set_limit(int resource, rlim_t value) {
  rlimit limit{value, value};
  if (::setrlimit(resource, &limit) == 0) return true;
  if (::getrlimit(resource, &limit) != 0) return false;
  limit.rlim_max = std::min(limit.rlim_max, value);
  limit.rlim_cur = std::min(limit.rlim_cur, limit.rlim_max);
  return ::setrlimit(resource, &limit) == 0;
}

/// Returns the current size of the address space, to which its limit is relative.
std::size_t address_space_bytes() {
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

/// One processor, so that codecs start no threads, which the filter forbids.
bool stay_on_this_processor() {
  const int processor = ::sched_getcpu();
  if (processor < 0 || processor >= CPU_SETSIZE) return false;
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(processor, &one);
  return ::sched_setaffinity(0, sizeof(one), &one) == 0;
}

/// Adds a rule for calls whose argument has the bits of `value` among those of `mask`.
bool add_rule(scmp_filter_ctx filter, std::uint32_t action, int call, unsigned argument,
              std::uint64_t mask, std::uint64_t value) {
  const scmp_arg_cmp condition{argument, SCMP_CMP_MASKED_EQ, mask, value};
  return ::seccomp_rule_add_array(filter, action, call, 1, &condition) == 0;
}

bool load_filter() {
  const std::unique_ptr<void, void (*)(scmp_filter_ctx)> owner(
      ::seccomp_init(SCMP_ACT_KILL_PROCESS), ::seccomp_release);
  scmp_filter_ctx const filter = owner.get();
  if (filter == nullptr) return false;
  constexpr std::uint32_t kRefuse = SCMP_ACT_ERRNO(EACCES);
  for (const int call : kAllowed)
    if (::seccomp_rule_add(filter, SCMP_ACT_ALLOW, call, 0) != 0) return false;
  for (const int call : kRefused)
    if (::seccomp_rule_add(filter, kRefuse, call, 0) != 0) return false;
  for (const int call : {SCMP_SYS(mmap), SCMP_SYS(mprotect)})
    if (!add_rule(filter, SCMP_ACT_ALLOW, call, 2, PROT_EXEC, 0)) return false;
  // fstat() of glibc: the empty path means the descriptor itself.
  constexpr int kStat = SCMP_SYS(newfstatat);
  return add_rule(filter, SCMP_ACT_ALLOW, kStat, 3, AT_EMPTY_PATH, AT_EMPTY_PATH) &&
         add_rule(filter, kRefuse, kStat, 3, AT_EMPTY_PATH, 0) && ::seccomp_load(filter) == 0;
}

}  // namespace

bool filters_system_calls() { return kHasFilter; }

bool enter_sandbox(const ReaderLimits& limits) {
  ::signal(SIGXFSZ, SIG_IGN);  // write() fails instead.
  const auto time_s = static_cast<rlim_t>(limits.time.count() / 1000 + 1);
  return set_limit(RLIMIT_CORE, 0) && set_limit(RLIMIT_CPU, time_s) &&
         set_limit(RLIMIT_FSIZE, limits.memory_bytes) &&
         set_limit(RLIMIT_AS, address_space_bytes() + limits.memory_bytes) &&
         stay_on_this_processor() && ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
         (!kHasFilter || load_filter());
}

}  // namespace lefort::io
