// JSON as text that any reader takes.
#pragma once

#include <string>

namespace rigmap {

// Of nlohmann's json or ordered_json. Paths and other programs' words need not be UTF-8, as JSON
// must: what is not is replaced. Without an indent it is one line.
template <class Json>
std::string JsonText(const Json& json, int indent = -1) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace rigmap
