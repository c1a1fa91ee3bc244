#include <lefort/bench/run_process.h>
#include <lefort/bench/stopwatch.h>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <utility>

namespace lefort::bench {

Result<std::string> run_process(const std::vector<std::string>& arguments, Progress& progress) {
  LEFORT_TRY(ProcessRun run, run_measured_process(arguments, progress));
  if (run.exit_code != 0)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("'{}' ended with {}", fmt::join(arguments, " "), run.exit_code));
  return std::move(run.output);
}

Result<ProcessRun> run_measured_process(const std::vector<std::string>& arguments,
                                        Progress& progress) {
  const double begin = now_seconds();
  std::array<int, 2> pipe{};
  if (::pipe2(pipe.data(), O_CLOEXEC) != 0)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("cannot start {}: {}", arguments[0], std::strerror(errno)));
  std::vector<char*> argv;
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, pipe[1], STDOUT_FILENO);
  pid_t child = 0;
  const int error = ::posix_spawn(&child, argv[0], &actions, nullptr, argv.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  ::close(pipe[1]);
  if (error != 0) {
    ::close(pipe[0]);
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("cannot start {}: {}", arguments[0], std::strerror(error)));
  }

  std::string output;
  bool stopped = false;
  constexpr int kPoll_ms = 200;
  for (;;) {
    pollfd ready{pipe[0], POLLIN, 0};
    if (::poll(&ready, 1, kPoll_ms) > 0) {
      std::array<char, 4096> buffer{};
      const ssize_t count = ::read(pipe[0], buffer.data(), buffer.size());
      if (count <= 0) break;
      output.append(buffer.data(), std::size_t(count));
    }
    if (!stopped && progress.stop_requested()) {
      ::kill(child, SIGKILL);
      stopped = true;
    }
  }
  ::close(pipe[0]);
  int status = 0;
  rusage usage{};
  while (::wait4(child, &status, 0, &usage) < 0 && errno == EINTR) {
  }
  if (stopped) return fail(ErrorCode::kCancelled, "the benchmark was cancelled");
  constexpr std::size_t kUnit = 1024;  // Of ru_maxrss.
  return ProcessRun{.output = std::move(output),
                    .seconds = now_seconds() - begin,
                    .peak_bytes = std::size_t(usage.ru_maxrss) * kUnit,
                    .exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status)};
}

}  // namespace lefort::bench
