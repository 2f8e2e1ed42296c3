#include "colmap/internal/descriptor.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>

#include "colmap/internal/process_group.h"

namespace rigmap {

Descriptor::Descriptor(int fd) : fd_(fd) {
  if (fd < 0 || fd > STDERR_FILENO) return;
  fd_ = fcntl(fd, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
  close(fd);
}

void Descriptor::Close() {
  if (fd_ >= 0) close(fd_);
  fd_ = -1;
}

Pipe OpenPipe(const std::string& program) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) throw CannotStart(program);
  return {Descriptor(ends[0]), Descriptor(ends[1])};
}

}  // namespace rigmap
