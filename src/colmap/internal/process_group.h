// A process group that does not outlive this process, however it ends.
#pragma once

#include <sys/types.h>

#include <string>
#include <utility>

#include "colmap/internal/descriptor.h"
#include "core/error.h"

namespace rigmap {

// "PROGRAM: cannot be started: REASON", from errno.
ToolError CannotStart(const std::string& program);

// Its first member is a fork of this process that only waits for the end of a pipe whose other end
// nobody but this process holds, and then kills the group: also what a program in it has started,
// such as the real COLMAP of a wrapper script. A process that leaves the group escapes. The member
// keeps the group's id from being given to others while this object lives.
class ProcessGroup {
 public:
  // For `program`, which a ToolError names when there can be no such group.
  explicit ProcessGroup(const std::string& program);
  ProcessGroup(ProcessGroup&& other) noexcept
      : id_(std::exchange(other.id_, -1)), lifeline_(std::move(other.lifeline_)) {}
  ~ProcessGroup() { End(); }

  pid_t Id() const { return id_; }
  // Kills all members. Those that are children of this process are still to be waited for, but not
  // the first.
  void End();

 private:
  pid_t id_;
  Descriptor lifeline_;
};

}  // namespace rigmap
