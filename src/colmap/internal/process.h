// Runs another program and waits for it.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace rigmap {

struct ProcessRequest {
  std::string program;  // a path, or a name that is looked up on PATH
  std::vector<std::string> arguments = {};
  // Gets the command line and all output, appended; its folder is created. Empty: no log.
  std::filesystem::path log_path = {};
  std::vector<std::pair<std::string, std::string>> environment = {};  // added to this process's own
  std::function<void(const std::string& line)> on_line = {};          // each line of output, if set
  double timeout_s = 0.0;                 // killed after this time; 0: never
  double timeout_without_output_s = 0.0;  // killed after being silent for so long; 0: never
};

struct ProcessResult {
  int exit_code = 0;  // meaningful where signal is 0
  int signal = 0;     // that ended it; 0: it ended by itself
  bool timed_out = false;
  double seconds = 0.0;  // wall time
  // Upper bound of the child's resident memory: the kernel's maximum includes what this process
  // had resident when it forked.
  double peak_rss_mb = 0.0;
  std::vector<std::string> last_lines;  // of the output, up to 5, none empty

  bool Succeeded() const { return signal == 0 && exit_code == 0; }
};

// The executable file that a shell would run for `name`: a name with a slash is taken as a path.
std::optional<std::filesystem::path> FindOnPath(const std::string& name);

// Forks on the calling thread and waits. Standard output and error of the child come through one
// pipe; its standard input is empty. The child is killed when the calling *thread* ends for any
// reason (the kernel ties it to the thread that forked), also when `on_line` throws. What the child
// itself has started ends with it or with this process, unless it has left its process group, which
// is not the terminal's. Throws
// ToolError when the program is not found or cannot be started, DataError when the log cannot be
// written.
ProcessResult RunProcess(const ProcessRequest& request);

// As RunProcess; any other end than exit code 0 is a ToolError that says what was being done
// (`purpose`: "incremental mapping"), how the program ended, its last lines and where its log is.
ProcessResult RunTool(const ProcessRequest& request, const std::string& purpose);

// "(its last lines: a | b; log: FILE)", for a ToolError about a program that claimed success.
std::string DescribeOutput(const ProcessRequest& request, const ProcessResult& result);

}  // namespace rigmap
