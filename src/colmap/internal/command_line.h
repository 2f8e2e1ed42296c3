// How COLMAP's commands are called.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "colmap/installation.h"
#include "colmap/internal/process.h"

namespace rigmap {

// A command line in the making: COMMAND --NAME VALUE ...
class CommandLine {
 public:
  explicit CommandLine(const std::string& command) : arguments_{command} {}

  CommandLine& Path(const std::string& name, const std::filesystem::path& path) {
    return Text(name, path.string());
  }
  CommandLine& Number(const std::string& name, double value);
  CommandLine& Text(const std::string& name, const std::string& value);
  const std::vector<std::string>& Arguments() const { return arguments_; }

 private:
  std::vector<std::string> arguments_;
};

// With all that COLMAP stands on held to so many threads, and what it logs in one file: by itself
// it leaves a file of Ceres' iterations in the temporary folder at each run, and listens to none of
// glog's environment variables.
ProcessRequest ProcessOf(const ColmapInstallation& colmap, const CommandLine& command,
                         const std::filesystem::path& log, int threads);

}  // namespace rigmap
