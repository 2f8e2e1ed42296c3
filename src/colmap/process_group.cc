#include "colmap/internal/process_group.h"

#include <fmt/format.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <climits>
#include <cstring>

namespace rigmap {
namespace {

// In the first member, where only async-signal-safe calls are allowed. Nothing else stays open: a
// lock or a pipe that it held would not end with this process.
[[noreturn]] void KillGroupAtEndOf(int lifeline) {
  setpgid(0, 0);
  dup2(lifeline, STDIN_FILENO);
  close_range(STDIN_FILENO + 1, UINT_MAX, 0);
  char nothing = 0;
  while (read(STDIN_FILENO, &nothing, 1) < 0 && errno == EINTR) {
  }
  kill(0, SIGKILL);
  _exit(0);
}

}  // namespace

ToolError CannotStart(const std::string& program) {
  return ToolError(fmt::format("{}: cannot be started: {}", program, std::strerror(errno)));
}

ProcessGroup::ProcessGroup(const std::string& program) : id_(-1) {
  Pipe lifeline = OpenPipe(program);
  id_ = fork();
  if (id_ < 0) throw CannotStart(program);
  if (id_ == 0) KillGroupAtEndOf(lifeline.read_end.Get());
  setpgid(id_, id_);  // whoever comes first
  lifeline_ = std::move(lifeline.write_end);
}

void ProcessGroup::End() {
  if (id_ < 0) return;
  kill(-id_, SIGKILL);
  while (waitpid(id_, nullptr, 0) < 0 && errno == EINTR) {
  }
  id_ = -1;
}

}  // namespace rigmap
