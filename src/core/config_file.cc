#include "core/config_file.h"

namespace rigmap {

namespace fs = std::filesystem;

fs::path ConfigFile(const std::string& name) {
  const fs::path program = fs::read_symlink("/proc/self/exe");
  for (fs::path folder = program.parent_path(); folder.has_relative_path();
       folder = folder.parent_path()) {
    for (const char* config : {"config", "share/rigmap/config"}) {
      if (fs::exists(folder / config / name)) return folder / config / name;
    }
  }
  return fs::path("config") / name;
}

}  // namespace rigmap
