#include "colmap/internal/child.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "core/error.h"
#include "core/memory_peak.h"

namespace rigmap {
namespace {

// All that exec needs, made before the fork: afterwards only async-signal-safe calls are allowed.
class ExecArguments {
 public:
  ExecArguments(const std::filesystem::path& file, const ProcessRequest& request)
      : file_(file.string()) {
    texts_.push_back(request.program);
    texts_.insert(texts_.end(), request.arguments.begin(), request.arguments.end());
    const std::size_t argument_count = texts_.size();
    for (char** entry = environ; *entry; ++entry) {
      if (!IsReplaced(*entry, request)) texts_.emplace_back(*entry);
    }
    for (const auto& [name, value] : request.environment)
      texts_.push_back(fmt::format("{}={}", name, value));
    for (std::size_t i = 0; i < texts_.size(); ++i) {
      (i < argument_count ? arguments_ : environment_).push_back(texts_[i].data());
    }
    arguments_.push_back(nullptr);
    environment_.push_back(nullptr);
  }

  void Exec() const { execve(file_.c_str(), arguments_.data(), environment_.data()); }

 private:
  static bool IsReplaced(const std::string& entry, const ProcessRequest& request) {
    return std::any_of(
        request.environment.begin(), request.environment.end(),
        [&](const auto& variable) { return entry.rfind(variable.first + "=", 0) == 0; });
  }

  std::string file_;
  std::vector<std::string> texts_;
  std::vector<char*> arguments_, environment_;
};

struct ChildContext {
  pid_t parent, group;
  int input, output, failure;  // descriptors
};

// In the child.
[[noreturn]] void Fail(const ChildContext& context) {
  const int reason = errno;
  [[maybe_unused]] const ssize_t written = write(context.failure, &reason, sizeof(reason));
  _exit(127);
}

// In the child. Does not return: either exec succeeds or its errno goes through the failure pipe.
[[noreturn]] void BecomeProgram(const ExecArguments& exec, const ChildContext& context) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != context.parent) _exit(127);  // the parent died before the request was made
  if (setpgid(0, context.group) != 0) Fail(context);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  dup2(context.input, STDIN_FILENO);
  dup2(context.output, STDOUT_FILENO);
  dup2(context.output, STDERR_FILENO);
  exec.Exec();
  Fail(context);
}

// Whoever started us may have had ended children forgotten at once; we want to hear how they ended.
void HearOfChildren() {
  struct sigaction action {};
  if (sigaction(SIGCHLD, nullptr, &action) == 0 && action.sa_handler == SIG_IGN) {
    signal(SIGCHLD, SIG_DFL);
  }
}

// Nothing once exec has succeeded, else its errno.
std::optional<int> WaitForExec(int failure) {
  int reason = 0;
  ssize_t size = 0;
  while ((size = read(failure, &reason, sizeof(reason))) < 0 && errno == EINTR) {
  }
  return size > 0 ? std::optional<int>(reason) : std::nullopt;
}

}  // namespace

Child::~Child() {
  if (pid_ < 0) return;
  Kill();
  while (waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

// The child by its own id as well: it may have left the group.
void Child::Kill() {
  kill(pid_, SIGKILL);
  group_.End();
}

bool Child::Reap(ProcessResult& result) {
  int status = 0;
  rusage usage{};
  const pid_t ended = wait4(pid_, &status, WNOHANG, &usage);
  if (ended < 0 && errno != EINTR) {
    throw ToolError(fmt::format("process {}: cannot be waited for: {}", std::exchange(pid_, -1),
                                std::strerror(errno)));
  }
  if (ended != pid_) return false;
  pid_ = -1;
  group_.End();
  if (WIFSIGNALED(status)) result.signal = WTERMSIG(status);
  if (WIFEXITED(status)) result.exit_code = WEXITSTATUS(status);
  result.peak_rss_mb = static_cast<double>(usage.ru_maxrss) / 1024.0;
  CountChild(result.peak_rss_mb);
  return true;
}

std::optional<std::filesystem::path> FindOnPath(const std::string& name) {
  const auto is_program = [](const std::filesystem::path& file) {
    std::error_code ignored;
    return std::filesystem::is_regular_file(file, ignored) && access(file.c_str(), X_OK) == 0;
  };
  if (name.find('/') != std::string::npos) {
    return is_program(name) ? std::optional<std::filesystem::path>(name) : std::nullopt;
  }
  const char* path = std::getenv("PATH");
  std::string rest = path ? path : "";
  while (!rest.empty()) {
    const auto end = std::min(rest.find(':'), rest.size());
    const auto folder = std::filesystem::path(end == 0 ? "." : rest.substr(0, end));
    if (is_program(folder / name)) return folder / name;
    rest.erase(0, end + 1);
  }
  return std::nullopt;
}

Child StartChild(const ProcessRequest& request) {
  const auto file = FindOnPath(request.program);
  if (!file) {
    const char* path = std::getenv("PATH");
    throw ToolError(fmt::format("{}: no such program, looked it up on PATH ({})", request.program,
                                path ? path : "not set"));
  }
  const ExecArguments exec(*file, request);
  Pipe output = OpenPipe(request.program), failure = OpenPipe(request.program);
  const Descriptor input(open("/dev/null", O_RDONLY | O_CLOEXEC));
  HearOfChildren();
  ProcessGroup group(request.program);
  const ChildContext context{getpid(), group.Id(), input.Get(), output.write_end.Get(),
                             failure.write_end.Get()};
  const pid_t pid = fork();
  if (pid < 0) throw CannotStart(request.program);
  if (pid == 0) BecomeProgram(exec, context);
  Child child(pid, std::move(group), std::move(output.read_end));
  failure.write_end.Close();
  if (const auto reason = WaitForExec(failure.read_end.Get())) {
    errno = *reason;
    throw CannotStart(request.program);
  }
  fcntl(child.Output(), F_SETFL, O_NONBLOCK);
  return child;
}

}  // namespace rigmap
