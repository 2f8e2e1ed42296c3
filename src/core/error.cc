#include "core/error.h"

#include <fmt/format.h>

namespace rigmap {
namespace {

// Where the letter ends that a position may lie within: UTF-8 has no letter of more than four
// bytes.
std::size_t EndOfLetter(std::string_view text, std::size_t position) {
  const auto is_within = [&](std::size_t i) {
    return i < text.size() && (static_cast<unsigned char>(text[i]) & 0xC0) == 0x80;
  };
  std::size_t end = position;
  while (end < position + 3 && is_within(end)) ++end;
  return end;
}

}  // namespace

std::string Legible(std::string_view sentence) {
  constexpr std::size_t kLongest = 1000, kFirst = 600, kLast = 300;
  if (sentence.size() > kLongest) {
    const std::size_t end = EndOfLetter(sentence, kFirst),
                      begin = EndOfLetter(sentence, sentence.size() - kLast);
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
