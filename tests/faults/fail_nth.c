/* Makes one call of the C library fail, for script/faults. Loaded by LD_PRELOAD.
 *
 *   LEFORT_FAULT=KIND:N     the N-th call of that kind fails (from 1)
 *   LEFORT_FAULT=KIND:N+    that call and all later ones fail, as on a full disk
 *   LEFORT_FAULT_COUNT=FILE the number of calls of each kind is written to FILE at the end
 *
 * LEFORT_FAULT_TRAP stops a debugger at the fault. Calls are counted from main() on.
 * Kinds: alloc (ENOMEM), write (ENOSPC), fsync (EIO), rename (EIO). A child process continues with
 * the counts of its parent. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

extern void* __libc_malloc(size_t);
extern void* __libc_calloc(size_t, size_t);
extern void* __libc_realloc(void*, size_t);
extern void* __libc_memalign(size_t, size_t);

enum kind { ALLOC, WRITE, FSYNC, RENAME, KINDS };
static const char* const names[KINDS] = {"alloc", "write", "fsync", "rename"};
static atomic_long counts[KINDS];
static int failing_kind = -1;
static long failing_call;
static int fails_on;
static pid_t first_process;

static void start(void) {
  first_process = getpid();
  const char* fault = getenv("LEFORT_FAULT");
  for (int kind = 0; fault != NULL && kind < KINDS; ++kind) {
    const size_t length = strlen(names[kind]);
    if (strncmp(fault, names[kind], length) != 0 || fault[length] != ':') continue;
    failing_call = strtol(fault + length + 1, NULL, 10);
    fails_on = strchr(fault, '+') != NULL;
    failing_kind = kind;
  }
  for (int kind = 0; kind < KINDS; ++kind) atomic_store(&counts[kind], 0);
}

typedef int (*main_function)(int, char**, char**);
static main_function program;

static int started(int argc, char** argv, char** environment) {
  start();
  return program(argc, argv, environment);
}

/* glibc calls main() from here. */
int __libc_start_main(main_function of_program, int argc, char** argv, void (*init)(void),
                      void (*fini)(void), void (*rtld_fini)(void), void* stack_end) {
  int (*next)(main_function, int, char**, void (*)(void), void (*)(void), void (*)(void), void*);
  *(void**)&next = dlsym(RTLD_NEXT, "__libc_start_main");
  program = of_program;
  return next(started, argc, argv, init, fini, rtld_fini, stack_end);
}

__attribute__((destructor)) static void end(void) {
  const char* file = getenv("LEFORT_FAULT_COUNT");
  if (file == NULL || getpid() != first_process) return;
  char text[200];
  const int size = snprintf(text, sizeof text, "%ld %ld %ld %ld\n", atomic_load(&counts[ALLOC]),
                            atomic_load(&counts[WRITE]), atomic_load(&counts[FSYNC]),
                            atomic_load(&counts[RENAME]));
  failing_kind = -1;
  const int out = open(file, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (out < 0) return;
  if (write(out, text, (size_t)size) != size) perror(file);
  close(out);
}

static int fails(enum kind kind, int error) {
  const long call = atomic_fetch_add(&counts[kind], 1) + 1;
  if ((int)kind != failing_kind || call < failing_call) return 0;
  if (call > failing_call && !fails_on) return 0;
  if (getenv("LEFORT_FAULT_TRAP") != NULL) raise(SIGTRAP);
  errno = error;
  return 1;
}

void* malloc(size_t size) { return fails(ALLOC, ENOMEM) ? NULL : __libc_malloc(size); }
void* calloc(size_t count, size_t size) {
  return fails(ALLOC, ENOMEM) ? NULL : __libc_calloc(count, size);
}
void* realloc(void* old, size_t size) {
  return fails(ALLOC, ENOMEM) ? NULL : __libc_realloc(old, size);
}
void* memalign(size_t alignment, size_t size) {
  return fails(ALLOC, ENOMEM) ? NULL : __libc_memalign(alignment, size);
}
void* aligned_alloc(size_t alignment, size_t size) { return memalign(alignment, size); }
int posix_memalign(void** to, size_t alignment, size_t size) {
  if (fails(ALLOC, ENOMEM)) return ENOMEM;
  *to = __libc_memalign(alignment, size);
  return *to == NULL ? ENOMEM : 0;
}

/* Output to a terminal or a log is not a file: descriptors 1 and 2 do not fail. */
ssize_t write(int file, const void* bytes, size_t size) {
  static ssize_t (*next)(int, const void*, size_t);
  if (next == NULL) next = (ssize_t(*)(int, const void*, size_t))dlsym(RTLD_NEXT, "write");
  return file > 2 && fails(WRITE, ENOSPC) ? -1 : next(file, bytes, size);
}
ssize_t writev(int file, const struct iovec* parts, int count) {
  static ssize_t (*next)(int, const struct iovec*, int);
  if (next == NULL) next = (ssize_t(*)(int, const struct iovec*, int))dlsym(RTLD_NEXT, "writev");
  return file > 2 && fails(WRITE, ENOSPC) ? -1 : next(file, parts, count);
}
ssize_t pwrite(int file, const void* bytes, size_t size, off_t at) {
  static ssize_t (*next)(int, const void*, size_t, off_t);
  if (next == NULL) next = (ssize_t(*)(int, const void*, size_t, off_t))dlsym(RTLD_NEXT, "pwrite");
  return fails(WRITE, ENOSPC) ? -1 : next(file, bytes, size, at);
}
int fsync(int file) {
  static int (*next)(int);
  if (next == NULL) next = (int (*)(int))dlsym(RTLD_NEXT, "fsync");
  return fails(FSYNC, EIO) ? -1 : next(file);
}
int rename(const char* from, const char* to) {
  static int (*next)(const char*, const char*);
  if (next == NULL) next = (int (*)(const char*, const char*))dlsym(RTLD_NEXT, "rename");
  return fails(RENAME, EIO) ? -1 : next(from, to);
}
