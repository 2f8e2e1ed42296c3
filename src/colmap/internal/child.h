// A started program, for process.cc: the part that forks.
#pragma once

#include <sys/types.h>

#include <utility>

#include "colmap/internal/descriptor.h"
#include "colmap/internal/process.h"
#include "colmap/internal/process_group.h"

namespace rigmap {

// A running child; killed and reaped if it is abandoned. What it has started ends with it.
class Child {
 public:
  Child(pid_t pid, ProcessGroup group, Descriptor output)
      : pid_(pid), group_(std::move(group)), output_(std::move(output)) {}
  Child(Child&& other) noexcept
      : pid_(std::exchange(other.pid_, -1)),
        group_(std::move(other.group_)),
        output_(std::move(other.output_)) {}
  ~Child();

  // The reading end of its standard output and error, not blocking; -1 once closed.
  int Output() const { return output_.Get(); }
  void CloseOutput() { output_.Close(); }
  void Kill();
  // True once the child has ended, and then fills exit code, signal and peak memory. Not to be
  // called again after that.
  bool Reap(ProcessResult& result);

 private:
  pid_t pid_;
  ProcessGroup group_;
  Descriptor output_;
};

// Throws ToolError when the program is not found or cannot be started.
Child StartChild(const ProcessRequest& request);

}  // namespace rigmap
