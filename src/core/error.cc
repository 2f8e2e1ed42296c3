#include "core/error.h"

#include <fmt/format.h>

namespace rigmap {

namespace {

// Whether UTF-8 has a letter begin there.
bool BeginsLetter(char byte) { return (static_cast<unsigned char>(byte) & 0xC0) != 0x80; }

}  // namespace

std::string Legible(std::string_view sentence) {
  constexpr std::size_t kLongest = 1000, kFirst = 600, kLast = 300;
  if (sentence.size() > kLongest) {
    std::size_t end = kFirst, begin = sentence.size() - kLast;
    while (end > 0 && !BeginsLetter(sentence[end])) --end;
    while (begin < sentence.size() && !BeginsLetter(sentence[begin])) ++begin;
    return Legible(sentence.substr(0, end)) + " ... " + Legible(sentence.substr(begin));
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
