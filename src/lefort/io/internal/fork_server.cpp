#include <lefort/io/internal/fork_server.h>
#include <lefort/io/start_readers.h>

#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <exception>
#include <memory>
#include <mutex>
#include <new>
#include <span>
#include <string>

namespace lefort::io {

namespace {

constexpr std::size_t kMaxRequest = 1 << 16;
constexpr std::size_t kMaxDescriptors = 3;

/// What the program sends: this, the request, and the descriptors of input, result and reply.
struct Order {
  ReaderTask task = nullptr;
  ReaderLimits limits;
};

struct Message {
  std::size_t length = 0;
  std::array<Descriptor, kMaxDescriptors> descriptors;
};

/// Sends one message with descriptors (cmsg(3)).
bool send_message(int socket, std::span<const std::string_view> parts,
                  std::span<const int> descriptors) {
  std::array<iovec, 2> pieces{};
  for (std::size_t n = 0; n < parts.size(); ++n)
    pieces[n] = {const_cast<char*>(parts[n].data()), parts[n].size()};  // NOLINT: is only read.
  alignas(cmsghdr) std::array<char, CMSG_SPACE(kMaxDescriptors * sizeof(int))> space{};
  msghdr message{};
  message.msg_iov = pieces.data();
  message.msg_iovlen = parts.size();
  message.msg_control = space.data();
  message.msg_controllen = CMSG_SPACE(descriptors.size_bytes());
  cmsghdr* const control = CMSG_FIRSTHDR(&message);
  control->cmsg_level = SOL_SOCKET;
  control->cmsg_type = SCM_RIGHTS;
  control->cmsg_len = CMSG_LEN(descriptors.size_bytes());
  std::memcpy(CMSG_DATA(control), descriptors.data(), descriptors.size_bytes());
  ssize_t sent = -1;
  do sent = ::sendmsg(socket, &message, MSG_NOSIGNAL);
  while (sent < 0 && errno == EINTR);
  return sent >= 0;
}

/// Receives one message into `buffer`; its length is 0 at the end of the connection.
Message receive_message(int socket, std::span<char> buffer) {
  iovec piece{buffer.data(), buffer.size()};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(kMaxDescriptors * sizeof(int))> space{};
  msghdr message{};
  message.msg_iov = &piece;
  message.msg_iovlen = 1;
  message.msg_control = space.data();
  message.msg_controllen = space.size();
  ssize_t got = -1;
  do got = ::recvmsg(socket, &message, MSG_CMSG_CLOEXEC);
  while (got < 0 && errno == EINTR);
  Message received;
  const cmsghdr* const control = got > 0 ? CMSG_FIRSTHDR(&message) : nullptr;
  if (control != nullptr && control->cmsg_type == SCM_RIGHTS) {
    const std::size_t count = (control->cmsg_len - CMSG_LEN(0)) / sizeof(int);
    for (std::size_t n = 0; n < count && n < kMaxDescriptors; ++n) {
      int number = -1;
      std::memcpy(&number, CMSG_DATA(control) + n * sizeof(int), sizeof(int));
      received.descriptors[n] = Descriptor(number);
    }
  }
  received.length = static_cast<std::size_t>(std::max<ssize_t>(got, 0));
  return received;
}

/// Makes `numbers` the descriptors 3, 4, ... of this process, 0 to 2 /dev/null, and closes all
/// others. Ends the process if that fails, as on Linux before 5.9.
void keep_only(std::span<const int> numbers) {
  std::array<int, kMaxDescriptors> high{};
  for (std::size_t n = 0; n < numbers.size(); ++n)
    high[n] = ::fcntl(numbers[n], F_DUPFD_CLOEXEC, 16);
  const int nowhere = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  bool is_done = true;
  for (int standard = 0; standard < 3; ++standard)
    is_done = ::dup2(nowhere, standard) == standard && is_done;
  for (std::size_t n = 0; n < numbers.size(); ++n) {
    const int number = 3 + static_cast<int>(n);
    is_done = ::dup2(high[n], number) == number && is_done;
  }
  if (::close_range(3 + static_cast<unsigned>(numbers.size()), ~0U, 0) != 0 || !is_done) ::_exit(0);
}

/// Executes the task and writes its result; the header is last, so that it is that of a whole one.
void run_task(const Order& order, std::string_view request, int input, int result) {
  ResultWriter writer(result, sizeof(ResultHeader));
  ResultHeader header{.magic = ResultHeader::kComplete};
  try {
    if (const Result<void> done = order.task(input, request, writer); !done) {
      ResultWriter message(result, sizeof(ResultHeader));
      header.state = ResultHeader::kError;
      header.error = static_cast<std::uint32_t>(done.error().code);
      message.bytes(done.error().message.data(), done.error().message.size());
      writer = std::move(message);
    }
    if (!writer.flush()) header.state = ResultHeader::kNoMemory;
  } catch (const std::bad_alloc&) {
    header.state = ResultHeader::kNoMemory;
  } catch (const std::exception&) {
    return;  // As a crash.
  }
  header.length = writer.position() - sizeof(header);
  ResultWriter first(result, 0);
  first.bytes(&header, sizeof(header));
  (void)first.flush();  // Otherwise the header remains 0, as after a crash.
}

/// The life of a child.
[[noreturn]] void be_child(const Order& order, std::string_view request, const Message& message) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  constexpr int kInput = 3, kResult = 4;
  keep_only(std::array{message.descriptors[0].number(), message.descriptors[1].number()});
  if (enter_sandbox(order.limits)) run_task(order, request, kInput, kResult);
  ::_exit(0);  // Skips the clean-up, which is the program's.
}

/// The life of the fork server: until the program ends, and with it the other end of `socket`.
[[noreturn]] void be_fork_server(int socket) {
  // The program decides what Ctrl-C and the end of the terminal stop.
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) ::signal(signal, SIG_IGN);
  ::signal(SIGCHLD, SIG_DFL);
  ::prctl(PR_SET_NAME, "lefort-readers");
  keep_only(std::array{socket});
  socket = 3;
  std::string buffer(sizeof(Order) + kMaxRequest, '\0');
  while (true) {
    const Message message = receive_message(socket, buffer);
    while (::waitpid(-1, nullptr, WNOHANG) > 0) {  // Those that have ended since.
    }
    if (message.length < sizeof(Order)) ::_exit(0);
    Order order;
    std::memcpy(static_cast<void*>(&order), buffer.data(), sizeof(order));
    const pid_t child = ::fork();
    if (child == 0)
      be_child(order,
               std::string_view(buffer).substr(sizeof(Order), message.length - sizeof(Order)),
               message);
    const Descriptor process(child < 0 ? -1 : int(::syscall(SYS_pidfd_open, child, 0)));
    if (!process.is_open()) {
      if (child > 0) ::kill(child, SIGKILL);
      continue;  // The program finds its socket closed.
    }
    const std::string_view done = "1";
    send_message(message.descriptors[2].number(), std::span(&done, 1),
                 std::array{process.number()});
  }
}

/// The connection to the fork server.
///
/// A process that the program forks, as multiprocessing of Python does, has a copy of the
/// connection: messages are whole, so that both use the same server.
class ForkServer {
 public:
  ForkServer() { ::pthread_atfork(nullptr, nullptr, &ForkServer::after_fork); }

  /// Sends to the running server, or to a new one if there is none.
  bool send(std::span<const std::string_view> parts, std::span<const int> descriptors) {
    const std::scoped_lock lock(mutex_);
    if (socket_.is_open() && send_message(socket_.number(), parts, descriptors)) return true;
    start();
    return socket_.is_open() && send_message(socket_.number(), parts, descriptors);
  }
  void start_once() {
    const std::scoped_lock lock(mutex_);
    if (!socket_.is_open()) start();
  }
  void stop() {
    const std::scoped_lock lock(mutex_);
    // Forked processes have copies of the socket; the server would not end before they do.
    const bool is_ours = process_ > 0 && starter_ == ::getpid();
    if (is_ours && socket_.is_open()) ::shutdown(socket_.number(), SHUT_RDWR);
    socket_ = Descriptor();
    if (is_ours) ::waitpid(process_, nullptr, 0);
    process_ = -1;
  }

 private:
  /// In a forked process: another thread may have held the mutex, and no longer exists.
  static void after_fork();

  void start() {
    socket_ = Descriptor();
    std::array<int, 2> pair{};
    if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, pair.data()) != 0) return;
    Descriptor ours(pair[0]), its(pair[1]);
    const pid_t server = ::fork();
    if (server == 0) try {
        be_fork_server(its.number());
      } catch (const std::exception&) {
        ::_exit(0);  // The program finds its socket closed.
      }
    if (server < 0) return;
    process_ = server;
    starter_ = ::getpid();
    socket_ = std::move(ours);
  }

  std::mutex mutex_;
  Descriptor socket_;
  pid_t process_ = -1;
  pid_t starter_ = -1;  ///< The process that started the server.
};

ForkServer& fork_server() {
  static ForkServer server;  // One of the process, as standard output is.
  return server;
}

void ForkServer::after_fork() { std::construct_at(&fork_server().mutex_); }

Error no_child(const char* what) {
  return {ErrorCode::kOutOfMemory,
          std::string("no process can be started to read the file: ") + what};
}

}  // namespace

void start_readers() { fork_server().start_once(); }

void stop_readers() { fork_server().stop(); }

Result<ReaderChild> start_child(ReaderTask task, const Descriptor& input, std::string_view request,
                                const ReaderLimits& limits) {
  if (request.size() > kMaxRequest) return tl::unexpected(no_child("the request is too long"));
  ReaderChild child;
  child.result = Descriptor(::memfd_create("lefort-result", MFD_CLOEXEC | MFD_ALLOW_SEALING));
  std::array<int, 2> pair{-1, -1};
  const int made = ::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, pair.data());
  const Descriptor ours(pair[0]);
  Descriptor its(pair[1]);
  if (!child.result.is_open() || made != 0) return tl::unexpected(no_child(std::strerror(errno)));
  const Order order{task, limits};
  const std::array parts{std::string_view(reinterpret_cast<const char*>(&order), sizeof(order)),
                         request};
  if (!fork_server().send(parts, std::array{input.number(), child.result.number(), its.number()}))
    return tl::unexpected(no_child(std::strerror(errno)));
  its = Descriptor();  // So that the end of the fork server ends the wait.
  std::array<char, 8> answer{};
  Message reply = receive_message(ours.number(), answer);
  child.process = std::move(reply.descriptors[0]);
  if (!child.process.is_open()) return tl::unexpected(no_child("the fork server has failed"));
  return child;
}

}  // namespace lefort::io
