// Bytes as text.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace rigmap {

// RFC 4648, padded.
std::string Base64(std::span<const std::uint8_t> bytes);

}  // namespace rigmap
