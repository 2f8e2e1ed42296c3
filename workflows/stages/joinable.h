// What the stages of a part leave in joining/ for those who join it with others.
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <string_view>

#include "core/artefact.h"
#include "core/error.h"
#include "pipeline/stage.h"

namespace rigmap {

// `code` is that of the stage: with it changes the shape of what is kept.
template <class Value>
void PublishJoinable(Publication& publication, const char* name, std::string_view code,
                     const Value& value) {
  WriteArtefact(publication.Path(name), HashText(code), value);
}

// Throws DataError where the part has not come so far, or another version has left it.
template <class Value>
Value ReadJoinable(const std::filesystem::path& root, const char* name, std::string_view code) {
  const auto path = root / name;
  if (!std::filesystem::exists(path)) {
    throw DataError(fmt::format(
        "{}: expected a part to be joined (rigmap part, up to adjustment or further), found no {}",
        root.string(), name));
  }
  if (auto value = ReadArtefact<Value>(path, HashText(code))) return std::move(*value);
  throw DataError(fmt::format(
      "{}: expected what this version of rigmap leaves, found another's or a damaged file; run the "
      "part again",
      path.string()));
}

}  // namespace rigmap
