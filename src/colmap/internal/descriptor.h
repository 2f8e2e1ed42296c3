// File descriptors that end with their owner.
#pragma once

#include <string>
#include <utility>

namespace rigmap {

// A file descriptor of ours: closed on exec and never one of the three standard ones, so that
// giving it to a child by dup2 always makes a copy.
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

struct Pipe {
  Descriptor read_end, write_end;
};

// Throws ToolError that `program` cannot be started.
Pipe OpenPipe(const std::string& program);

}  // namespace rigmap
