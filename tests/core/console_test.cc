#include "core/console.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>

#include "core/error.h"

namespace rigmap {
namespace {

// Where a stream leads while this lives.
class Led {
 public:
  Led(std::FILE* stream, const char* path) : stream_(stream), before_(dup(fileno(stream))) {
    std::fflush(stream);
    const int there = open(path, O_WRONLY | O_CLOEXEC);
    dup2(there, fileno(stream));
    close(there);
  }
  ~Led() {
    dup2(before_, fileno(stream_));
    close(before_);
    std::clearerr(stream_);
  }
  Led(const Led&) = delete;
  Led& operator=(const Led&) = delete;

 private:
  std::FILE* stream_;
  int before_;
};

TEST(Say, SaysItAtOnce) {
  testing::internal::CaptureStderr();
  Say("{} of {}\n", 3, 4);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "3 of 4\n");
}

TEST(Say, GoesOnWhereNobodyCanBeTold) {
  const Led nowhere(stderr, "/dev/full");
  EXPECT_NO_THROW(Say("{}\n", 1));
}

TEST(PrintResult, PrintsAllOfIt) {
  testing::internal::CaptureStdout();
  PrintResult("{\"parts\": 2}\n");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "{\"parts\": 2}\n");
}

TEST(PrintResult, FailsWhereTheDiskIsFull) {
  const Led nowhere(stdout, "/dev/full");
  EXPECT_THROW(PrintResult("{\"parts\": 2}\n"), DataError);
}

}  // namespace
}  // namespace rigmap
