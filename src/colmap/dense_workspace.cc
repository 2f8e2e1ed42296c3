#include "colmap/dense_workspace.h"

#include <fmt/format.h>

#include <bit>
#include <ostream>
#include <stdexcept>

#include "core/error.h"
#include "core/file.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

static_assert(std::endian::native == std::endian::little, "the files are little endian");

void WriteChannels(const fs::path& path, const StereoView& view, std::span<const float> values,
                   std::size_t channels) {
  const std::size_t pixels =
      static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
  if (values.size() != pixels * channels) {
    throw std::logic_error(fmt::format("{}: expected {} x {} x {} values, found {}", path.string(),
                                       view.width, view.height, channels, values.size()));
  }
  WriteFileAtomically(path, [&](std::ostream& stream) {
    stream << view.width << '&' << view.height << '&' << channels << '&';
    stream.write(reinterpret_cast<const char*>(values.data()),
                 static_cast<std::streamsize>(values.size_bytes()));
  });
}

}  // namespace

void WriteStereoView(const StereoView& view, const fs::path& workspace) {
  const std::string file = view.name + ".geometric.bin";
  WriteChannels(workspace / "stereo" / "depth_maps" / file, view, view.depth, 1);
  WriteChannels(workspace / "stereo" / "normal_maps" / file, view, view.normals, 3);
}

void WriteStereoLists(const std::vector<std::string>& names, const fs::path& workspace) {
  const fs::path stereo = workspace / "stereo";
  WriteFileAtomically(stereo / "fusion.cfg", [&](std::ostream& stream) {
    for (const std::string& name : names) stream << name << '\n';
  });
  WriteFileAtomically(stereo / "patch-match.cfg", [&](std::ostream& stream) {
    for (const std::string& name : names) stream << name << "\n__auto__, 20\n";
  });
  std::error_code error;
  fs::create_directories(stereo / "consistency_graphs", error);
  if (error) {
    throw DataError(fmt::format("{}: cannot be made: {}", (stereo / "consistency_graphs").string(),
                                error.message()));
  }
}

}  // namespace rigmap
