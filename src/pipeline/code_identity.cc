#include "pipeline/code_identity.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace rigmap {

std::string_view CodeHere(const std::source_location& here) {
  const std::string_view file = here.file_name();
  const std::string_view unit = file.substr(0, file.rfind('.'));
  const auto identities = CodeIdentities();
  const auto found = std::ranges::find_if(identities, [&](const CodeIdentity& identity) {
    return unit == identity.unit || unit.ends_with(fmt::format("/{}", identity.unit));
  });
  if (found == identities.end()) {
    throw std::logic_error(fmt::format("{}: no code identity was built for it", file));
  }
  return found->hash;
}

}  // namespace rigmap
