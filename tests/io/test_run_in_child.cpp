// A reader that crashes, needs too much, hangs or is taken over by its file harms nothing.
#include <lefort/io/internal/run_in_child.h>
#include <lefort/io/start_readers.h>

#include <dirent.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

#include "support/stop_at_once.h"
#include "support/temporary_folder.h"
#include "support/text.h"

namespace lefort::io::test_run_in_child {
namespace {

using test::contains;

/// Writes the length of the file and the request.
Result<void> measure(int input, std::string_view request, ResultWriter& result) {
  LEFORT_TRY(const std::string bytes, read_all(input, "the bytes"));
  result.number(static_cast<std::uint64_t>(bytes.size()));
  result.text(request);
  return {};
}

Result<void> reject(int /*input*/, std::string_view /*request*/, ResultWriter& result) {
  result.number(1);
  return fail(ErrorCode::kMeshInvalid, "a\x1b[31m line\nand another");
}

Result<void> write_to_null(int /*input*/, std::string_view /*request*/, ResultWriter& result) {
  result.number(1);
  volatile int* const nowhere = nullptr;
  *nowhere = 1;  // NOLINT: on purpose.
  return {};
}

Result<void> abort_as_a_library(int, std::string_view, ResultWriter&) { std::abort(); }

Result<void> leave(int, std::string_view, ResultWriter& result) {
  result.number(1);
  ::_exit(0);
}

Result<void> allocate(int, std::string_view, ResultWriter& result) {
  const std::vector<char> large(std::size_t{3} << 28, 'x');
  result.number(static_cast<int>(large[large.size() / 2]));
  return {};
}

Result<void> write_much(int, std::string_view, ResultWriter& result) {
  const std::vector<char> chunk(1 << 20);
  for (int n = 0; n < 300; ++n) result.bytes(chunk.data(), chunk.size());
  return {};
}

Result<void> loop(int, std::string_view, ResultWriter&) {
  for (std::atomic<int> turns = 0;; ++turns) {
  }
}

Result<void> open_a_file(int, std::string_view, ResultWriter&) {
  if (::open("/etc/passwd", O_RDONLY) >= 0) return {};
  return fail(ErrorCode::kFileCorrupt, std::strerror(errno));
}

Result<void> start_a_thread(int, std::string_view, ResultWriter& result) {
  result.number(static_cast<int>(std::thread::hardware_concurrency()));
  std::jthread([] {});
  return {};
}

Result<void> open_a_socket(int, std::string_view, ResultWriter& result) {
  result.number(::socket(AF_INET, SOCK_STREAM, 0));
  return {};
}

Result<void> start_a_process(int, std::string_view, ResultWriter& result) {
  result.number(static_cast<int>(::fork()));
  return {};
}

Result<void> execute(int, std::string_view, ResultWriter& result) {
  std::array<char*, 1> none{nullptr};
  result.number(::execve("/bin/true", none.data(), none.data()));
  return {};
}

Result<void> end_the_program(int, std::string_view, ResultWriter& result) {
  result.number(::kill(::getppid(), SIGTERM));
  return {};
}

Result<void> map_code(int, std::string_view, ResultWriter& result) {
  result.number(::mmap(nullptr, 4096, PROT_READ | PROT_WRITE | PROT_EXEC,
                       MAP_PRIVATE | MAP_ANONYMOUS, -1, 0) == MAP_FAILED);
  return {};
}

/// Writes the numbers of the open descriptors, and whether the input can be written.
Result<void> list_descriptors(int input, std::string_view, ResultWriter& result) {
  for (int number = 0; number < 256; ++number)
    if (::fcntl(number, F_GETFD) >= 0) result.number(number);
  result.number(::write(input, "x", 1) == 1 ? 1 : 0);
  return {};
}

int open_descriptors() {
  int count = 0;
  DIR* const folder = ::opendir("/proc/self/fd");
  while (::readdir(folder) != nullptr) ++count;
  ::closedir(folder);
  return count;
}

class RunInChild : public ::testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(file_) << "twelve bytes";
    start_readers();
    open_before_ = open_descriptors();
  }
  void TearDown() override {
    EXPECT_EQ(open_descriptors(), open_before_);
    ASSERT_TRUE(run(measure));  // Still works.
  }
  [[nodiscard]] Result<ReaderValues> run(ReaderTask task, const ReaderLimits& limits = {},
                                         Progress& progress = Progress::none()) const {
    const auto input = open_input(file_, "the file");
    if (!input) return tl::unexpected(input.error());
    return run_in_child(input->descriptor, {task, "the bytes", "request", limits}, progress);
  }
  /// The message of an error that is not that of the task.
  [[nodiscard]] std::string error(ReaderTask task, const ReaderLimits& limits = {}) const {
    const auto result = run(task, limits);
    if (result) return "no error";
    EXPECT_EQ(result.error().code, ErrorCode::kFileCorrupt);
    return result.error().message;
  }

  test::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_ / "file";
  int open_before_ = 0;
};

constexpr const char* kCrash = "the bytes are truncated or damaged";

TEST_F(RunInChild, ReturnsWhatTheTaskWrites) {
  auto result = run(measure);
  ASSERT_TRUE(result) << result.error().message;
  std::uint64_t bytes = 0;
  std::string request;
  ASSERT_TRUE((*result)->number(bytes) && (*result)->text(request) && (*result)->at_end());
  EXPECT_EQ(bytes, 12U);
  EXPECT_EQ(request, "request");
}

TEST_F(RunInChild, ReturnsTheErrorOfTheTaskInPrintableCharacters) {
  const auto result = run(reject);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::kMeshInvalid);
  EXPECT_EQ(result.error().message, "a?[31m line?and another");
}

TEST_F(RunInChild, SurvivesACrash) {
  EXPECT_EQ(error(write_to_null), kCrash);
  EXPECT_EQ(error(abort_as_a_library), kCrash);
  EXPECT_EQ(error(leave), kCrash);  // Values without the header of a whole result.
}

TEST_F(RunInChild, LimitsMemoryAndResult) {
  if (!filters_system_calls()) GTEST_SKIP() << "a sanitizer ends the child itself";
  EXPECT_TRUE(contains(error(allocate, {.memory_bytes = std::size_t{1} << 28}),
                       "the bytes need more than 268435456 bytes"));
  EXPECT_TRUE(contains(error(write_much, {.memory_bytes = std::size_t{1} << 28}),
                       "the bytes need more than 268435456 bytes"));
  EXPECT_TRUE(run(allocate, {.memory_bytes = std::size_t{1} << 30}));
}

TEST_F(RunInChild, EndsALoop) {
  const auto start = std::chrono::steady_clock::now();
  EXPECT_TRUE(contains(error(loop, {.time = std::chrono::milliseconds(100)}),
                       "the bytes take longer than 100 ms"));
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
}

TEST_F(RunInChild, IsStoppedByTheUser) {
  class StopAfterAWhile : public Progress {
   public:
    [[nodiscard]] bool stop_requested() const override { return ++asked_ > 3; }

   private:
    mutable std::atomic<int> asked_ = 0;
  } progress;
  const auto result = run(loop, {}, progress);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::kCancelled);
  test::StopAtOnce at_once;
  EXPECT_EQ(run(measure, {}, at_once).error().code, ErrorCode::kCancelled);
}

TEST_F(RunInChild, CannotOpenOrStartAnything) {
  if (!filters_system_calls()) GTEST_SKIP() << "this build has a sanitizer and no filter";
  EXPECT_EQ(error(open_a_file), "Permission denied");
  for (const ReaderTask task :
       {start_a_thread, open_a_socket, start_a_process, execute, end_the_program, map_code})
    EXPECT_EQ(error(task), kCrash);
}

TEST_F(RunInChild, HasNoDescriptorOfTheProgram) {
  const Descriptor secret(::open("/dev/null", O_RDWR));  // Not closed by exec.
  auto result = run(list_descriptors);
  ASSERT_TRUE(result) << result.error().message;
  std::vector<int> numbers;
  for (int number = 0; (*result)->number(number);) numbers.push_back(number);
  EXPECT_EQ(numbers, (std::vector<int>{0, 1, 2, 3, 4, 0}));
  std::ifstream file(file_);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), "twelve bytes");
}

TEST_F(RunInChild, ServesManyThreads) {
  std::atomic<int> good = 0;
  {
    std::vector<std::jthread> threads;
    for (int n = 0; n < 8; ++n)
      threads.emplace_back([&, n] {
        for (int turn = 0; turn < 10; ++turn) {
          const bool crashes = (n + turn) % 3 == 0;
          const auto result = run(crashes ? write_to_null : measure);
          good += result.has_value() != crashes ? 1 : 0;
        }
      });
  }
  EXPECT_EQ(good, 80);
}

TEST_F(RunInChild, KeepsLowerLimitsOfTheUser) {
  const auto input = open_input(file_, "the file");
  ASSERT_TRUE(input);
  stop_readers();
  const pid_t program = ::fork();
  if (program == 0) {
    const rlimit low{1 << 20, 1 << 20};
    constexpr uid_t kNobody = 65534;  // Root could raise the limit.
    if (::setrlimit(RLIMIT_FSIZE, &low) != 0 || (::geteuid() == 0 && ::setuid(kNobody) != 0))
      ::_exit(2);
    ::_exit(run_in_child(input->descriptor, {measure, "the bytes"}, Progress::none()) ? 0 : 1);
  }
  int status = -1;
  ASSERT_EQ(::waitpid(program, &status, 0), program);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
  start_readers();
}

TEST_F(RunInChild, StartsAgainAfterTheForkServerEnded) {
  stop_readers();
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1);  // No child is left.
  EXPECT_TRUE(run(measure));
}

TEST_F(RunInChild, ServesAForkedProcess) {
  ASSERT_TRUE(run(measure));
  const pid_t forked = ::fork();
  if (forked == 0) {
    const bool is_read = run(measure).has_value();
    stop_readers();  // Ends its use of them, not the readers of the program.
    ::_exit(is_read ? 0 : 1);
  }
  int status = -1;
  ASSERT_EQ(::waitpid(forked, &status, 0), forked);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  EXPECT_TRUE(run(measure));
}

TEST_F(RunInChild, StopsWhileAForkedProcessLives) {
  ASSERT_TRUE(run(measure));
  const pid_t forked = ::fork();
  if (forked == 0) {
    ::pause();
    ::_exit(0);
  }
  stop_readers();  // Would wait forever if it waited for the copy of the connection.
  EXPECT_EQ(::waitpid(forked, nullptr, WNOHANG), 0);
  ::kill(forked, SIGKILL);
  EXPECT_EQ(::waitpid(forked, nullptr, 0), forked);
  EXPECT_TRUE(run(measure));
}

TEST_F(RunInChild, EndsWithTheProgram) {
  // A program of its own: it starts a fork server, a child that loops, and is killed.
  const pid_t program = ::fork();
  if (program == 0) {
    ::execl("/proc/self/exe", "test_readers_in_child", "--gtest_also_run_disabled_tests",
            "--gtest_filter=*DISABLED_Loops", nullptr);
    ::_exit(1);
  }
  const auto children_of = [](pid_t parent) {
    std::ifstream list("/proc/" + std::to_string(parent) + "/task/" + std::to_string(parent) +
                       "/children");
    return std::vector<pid_t>(std::istream_iterator<pid_t>(list), {});
  };
  std::vector<pid_t> server, reader;
  for (int turn = 0; turn < 1000 && reader.empty(); ++turn) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    server = children_of(program);
    if (!server.empty()) reader = children_of(server[0]);
  }
  ASSERT_EQ(reader.size(), 1U);
  ::kill(program, SIGKILL);
  ASSERT_EQ(::waitpid(program, nullptr, 0), program);
  const auto is_running = [](pid_t process) {
    std::ifstream status("/proc/" + std::to_string(process) + "/stat");
    std::string number, name, state;
    status >> number >> name >> state;
    return !state.empty() && state != "Z";
  };
  for (int turn = 0; turn < 1000 && (is_running(server[0]) || is_running(reader[0])); ++turn)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_FALSE(is_running(server[0]));
  EXPECT_FALSE(is_running(reader[0]));
}

TEST_F(RunInChild, DISABLED_Loops) { (void)run(loop); }

}  // namespace
}  // namespace lefort::io::test_run_in_child
