#include "core/error.h"

#include <fmt/format.h>

namespace rigmap {

std::string Legible(std::string_view sentence) {
  constexpr std::size_t kLongest = 1000, kFirst = 600, kLast = 300;
  if (sentence.size() > kLongest) {
    return Legible(sentence.substr(0, kFirst)) + " ... " +
           Legible(sentence.substr(sentence.size() - kLast));
  }
  std::string legible;
  for (const char letter : sentence) {
    const auto byte = static_cast<unsigned char>(letter);
    if (letter == '\n') {
      legible += "\\n";
    } else if (byte < 0x20 || byte == 0x7f) {
      legible += fmt::format("\\x{:02x}", byte);
    } else {
      legible += letter;
    }
  }
  return legible;
}

}  // namespace rigmap
