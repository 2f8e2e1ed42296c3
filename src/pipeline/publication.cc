#include <fmt/format.h>

#include <stdexcept>

#include "core/file.h"
#include "pipeline/stage.h"

namespace rigmap {

std::filesystem::path Publication::Path(const std::string& name) {
  if (!declared_.contains(name)) {
    throw std::logic_error(fmt::format("{} is published but was not declared", name));
  }
  written_.insert(name);
  return root_ / name;
}

void Publication::File(const std::string& name, const std::function<void(std::ostream&)>& write) {
  WriteFileAtomically(Path(name), write);
}

void Publication::Folder(const std::string& name,
                         const std::function<void(const std::filesystem::path&)>& fill) {
  WriteFolderAtomically(Path(name), fill);
}

}  // namespace rigmap
