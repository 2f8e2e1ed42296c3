// A started program, for process.cc: the part that forks.
#pragma once

#include <sys/types.h>

#include <utility>

#include "colmap/process.h"

namespace rigmap {

// A file descriptor of ours: closed on exec and never one of the three standard ones, so that
// giving it to the child by dup2 always makes a copy.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int fd);
  Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  ~Descriptor() { Close(); }
  int Get() const { return fd_; }
  void Close();

 private:
  int fd_ = -1;
};

// A running child; killed and reaped if it is abandoned.
class Child {
 public:
  Child(pid_t pid, Descriptor output) : pid_(pid), output_(std::move(output)) {}
  Child(Child&& other) noexcept
      : pid_(std::exchange(other.pid_, -1)), output_(std::move(other.output_)) {}
  ~Child();

  // The reading end of its standard output and error, not blocking; -1 once closed.
  int Output() const { return output_.Get(); }
  void CloseOutput() { output_.Close(); }
  void Kill() const;
  // True once the child has ended, and then fills exit code, signal and peak memory. Not to be
  // called again after that.
  bool Reap(ProcessResult& result);

 private:
  pid_t pid_;
  Descriptor output_;
};

// Throws ToolError when the program is not found or cannot be started.
Child StartChild(const ProcessRequest& request);

}  // namespace rigmap
