// JSON files that lay about since they were written.
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/error.h"

namespace rigmap {

// What `take` makes of values from the file at `path`. Where one is missing or of another type, a
// DataError: "PATH: expected WHAT, found something else".
template <class Take>
auto TakeFromJson(const std::filesystem::path& path, const char* what, const Take& take) {
  try {
    return take();
  } catch (const nlohmann::json::exception&) {
    throw DataError(fmt::format("{}: expected {}, found something else", path.string(), what));
  }
}

}  // namespace rigmap
