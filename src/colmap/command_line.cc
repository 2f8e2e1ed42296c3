#include "colmap/internal/command_line.h"

#include <fmt/format.h>

#include <utility>

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
  std::vector<std::string> arguments = command.Arguments();
  arguments.insert(arguments.end(), {"--log_to_stderr", "1", "--log_level", "0"});
  return {
      .program = colmap.path,
      .arguments = std::move(arguments),
      .log_path = log,
      // Eigen, Ceres and BLAS below COLMAP: together no more than their share.
      .environment = {{"OMP_NUM_THREADS", std::to_string(threads)}, {"OPENBLAS_NUM_THREADS", "1"}},
      .timeout_without_output_s = colmap.patience_s};
}

}  // namespace rigmap
