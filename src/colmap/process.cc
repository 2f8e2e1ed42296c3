#include "colmap/internal/process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>

#include "colmap/internal/child.h"
#include "core/error.h"

namespace rigmap {
namespace {

using Clock = std::chrono::steady_clock;
constexpr int kTick_ms = 50;            // how often timeouts and the child's end are looked at
constexpr int kTickAfterOutput_ms = 2;  // once its output is closed, the end is near
constexpr std::size_t kLastLines = 5;
constexpr std::size_t kLongestCommand = 160;  // characters of it shown in messages

double SecondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

void WriteAll(int fd, const char* data, std::size_t size, const std::filesystem::path& path) {
  while (size > 0) {
    const ssize_t written = write(fd, data, size);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) {
      throw DataError(fmt::format("{}: cannot write: {}", path.string(), std::strerror(errno)));
    }
    data += written;
    size -= static_cast<std::size_t>(written);
  }
}

std::string CommandText(const ProcessRequest& request) {
  std::string line = request.program;
  for (const auto& argument : request.arguments) {
    const bool plain = argument.find_first_of(" \t\"'\\$") == std::string::npos;
    line += plain && !argument.empty() ? " " + argument : fmt::format(" '{}'", argument);
  }
  return line;
}

Descriptor OpenLog(const ProcessRequest& request) {
  if (request.log_path.empty()) return {};
  std::error_code ignored;
  std::filesystem::create_directories(request.log_path.parent_path(), ignored);
  Descriptor log(open(request.log_path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666));
  if (log.Get() < 0) {
    throw DataError(
        fmt::format("{}: cannot write: {}", request.log_path.string(), std::strerror(errno)));
  }
  const std::string heading = "$ " + CommandText(request) + "\n";
  WriteAll(log.Get(), heading.data(), heading.size(), request.log_path);
  return log;
}

// Cuts the output into lines, for the log, the caller and the tail.
class Listener {
 public:
  explicit Listener(const ProcessRequest& request) : request_(request), log_(OpenLog(request)) {}

  // Reads what there is. False at the end of the output.
  bool Listen(int fd) {
    std::array<char, 65536> buffer;
    ssize_t size = 0;
    while ((size = read(fd, buffer.data(), buffer.size())) > 0) {
      last_heard_ = Clock::now();
      const auto count = static_cast<std::size_t>(size);
      if (log_.Get() >= 0) WriteAll(log_.Get(), buffer.data(), count, request_.log_path);
      for (std::size_t i = 0; i < count; ++i) Take(buffer[i]);
    }
    return size < 0 && (errno == EAGAIN || errno == EINTR);
  }

  std::vector<std::string> Finish() {
    if (!line_.empty()) EndLine();
    return std::move(last_lines_);
  }

  double SilentSeconds() const { return SecondsSince(last_heard_); }

 private:
  void Take(char character) {
    if (character == '\n') {
      EndLine();
    } else if (character != '\r') {
      line_ += character;
    }
  }

  void EndLine() {
    if (request_.on_line) request_.on_line(line_);
    if (line_.find_first_not_of(" \t=-") != std::string::npos) last_lines_.push_back(line_);
    if (last_lines_.size() > kLastLines) last_lines_.erase(last_lines_.begin());
    line_.clear();
  }

  const ProcessRequest& request_;
  Descriptor log_;
  std::string line_;
  std::vector<std::string> last_lines_;
  Clock::time_point last_heard_ = Clock::now();
};

bool IsOverdue(const ProcessRequest& request, Clock::time_point start, const Listener& listener) {
  return (request.timeout_s > 0.0 && SecondsSince(start) > request.timeout_s) ||
         (request.timeout_without_output_s > 0.0 &&
          listener.SilentSeconds() > request.timeout_without_output_s);
}

std::string DescribeEnd(const ProcessResult& result) {
  if (result.timed_out)
    return fmt::format("was killed after {:.0f} s without an end", result.seconds);
  if (result.signal == 0) return fmt::format("ended with exit code {}", result.exit_code);
  const char* name = sigabbrev_np(result.signal);
  return fmt::format("was ended by signal {}{}", name ? "SIG" : "",
                     name ? std::string(name) : std::to_string(result.signal));
}

}  // namespace

ProcessResult RunProcess(const ProcessRequest& request) {
  Listener listener(request);
  const auto start = Clock::now();
  Child child = StartChild(request);
  ProcessResult result;
  bool ended = false;
  while (!ended) {
    const bool talking = child.Output() >= 0;
    pollfd event{.fd = child.Output(), .events = POLLIN, .revents = 0};
    poll(&event, 1, talking ? kTick_ms : kTickAfterOutput_ms);
    // A grandchild may hold the pipe open: the end of the child decides, not that of its output.
    ended = child.Reap(result);
    if (talking && !listener.Listen(child.Output())) child.CloseOutput();
    if (!ended && !result.timed_out && IsOverdue(request, start, listener)) {
      result.timed_out = true;
      child.Kill();
    }
  }
  result.seconds = SecondsSince(start);
  result.last_lines = listener.Finish();
  return result;
}

ProcessResult RunTool(const ProcessRequest& request, const std::string& purpose) {
  ProcessResult result = RunProcess(request);
  if (result.Succeeded()) return result;
  std::string command = CommandText(request);
  if (command.size() > kLongestCommand) command = command.substr(0, kLongestCommand) + " ...";
  throw ToolError(fmt::format("{}: '{}' {} {}", purpose, command, DescribeEnd(result),
                              DescribeOutput(request, result)));
}

std::string DescribeOutput(const ProcessRequest& request, const ProcessResult& result) {
  const std::string log =
      request.log_path.empty() ? "" : fmt::format("; log: {}", request.log_path.string());
  if (result.last_lines.empty()) return fmt::format("(it printed nothing{})", log);
  return fmt::format("(its last lines: {}{})", fmt::join(result.last_lines, " | "), log);
}

}  // namespace rigmap
