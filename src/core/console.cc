#include "core/console.h"

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "core/error.h"

namespace rigmap {

void SayText(std::string_view text) noexcept {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

void PrintResult(std::string_view text) {
  errno = 0;
  const std::size_t written = std::fwrite(text.data(), 1, text.size(), stdout);
  if (std::fflush(stdout) == 0 && written == text.size()) return;
  throw DataError(fmt::format("standard output: cannot write: {}", std::strerror(errno)));
}

}  // namespace rigmap
