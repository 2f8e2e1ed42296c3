#include "colmap/installation.h"

#include <fmt/format.h>

#include <cstdlib>
#include <regex>

#include "colmap/internal/process.h"
#include "core/error.h"

namespace rigmap {
namespace {

constexpr const char* kSupported = "3.8";

bool IsSupported(const std::string& version) {
  return version == kSupported || version.rfind(std::string(kSupported) + ".", 0) == 0;
}

}  // namespace

OptionFields ColmapOptions::Fields() {
  return {
      {"patience_s", &patience_s, "s", MoreThan(0.0),
       "A COLMAP that writes nothing for so long hangs and is killed. It says a word for each "
       "image, and its longest adjustments, of thousands of images, take a few minutes."},
  };
}

ColmapInstallation FindColmap(double patience_s) {
  const auto program = FindOnPath("colmap");
  if (!program) {
    const char* path = std::getenv("PATH");
    throw ToolError(fmt::format("colmap: not found on PATH ({}), expected COLMAP {}",
                                path ? path : "not set", kSupported));
  }
  ColmapInstallation installation{.path = program->string(), .version_text = {}};
  ProcessRequest request{.program = installation.path, .arguments = {"help"}};
  request.timeout_s = patience_s;
  request.on_line = [&](const std::string& line) {
    static const std::regex kVersion("COLMAP ([0-9]+\\.[0-9]\\S*)");
    std::smatch match;
    if (installation.version_text.empty() && std::regex_search(line, match, kVersion)) {
      installation.version_text = match[1];
    }
  };
  const ProcessResult result = RunTool(request, "asking COLMAP for its version");
  if (installation.version_text.empty()) {
    throw ToolError(fmt::format("{}: expected COLMAP {}, found a program that names no version {}",
                                installation.path, kSupported, DescribeOutput(request, result)));
  }
  if (!IsSupported(installation.version_text)) {
    throw ToolError(fmt::format("{}: expected COLMAP {}, found COLMAP {}", installation.path,
                                kSupported, installation.version_text));
  }
  return installation;
}

}  // namespace rigmap
