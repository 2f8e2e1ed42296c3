#include "colmap/internal/command_line.h"

#include <fmt/format.h>

namespace rigmap {

CommandLine& CommandLine::Number(const std::string& name, double value) {
  return Text(name, fmt::format("{}", value));
}

CommandLine& CommandLine::Text(const std::string& name, const std::string& value) {
  arguments_.push_back("--" + name);
  arguments_.push_back(value);
  return *this;
}

ProcessRequest ProcessOf(const ColmapInstallation& colmap, const CommandLine& command,
                         const std::filesystem::path& log, int threads) {
  return {.program = colmap.path,
          .arguments = command.Arguments(),
          .log_path = log,
          // Eigen, Ceres and BLAS below COLMAP: together no more than their share.
          // Without the last COLMAP leaves log files of its own in the temporary folder.
          .environment = {{"OMP_NUM_THREADS", std::to_string(threads)},
                          {"OPENBLAS_NUM_THREADS", "1"},
                          {"GLOG_logtostderr", "1"}},
          .timeout_without_output_s = colmap.patience_s};
}

}  // namespace rigmap
