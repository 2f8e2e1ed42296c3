#include "workflows/shell_word.h"

#include <string_view>

namespace rigmap {

std::string ShellWord(const std::string& word) {
  constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=:,./@%";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  std::string text(1, '\'');
  for (const char c : word) {
    if (c == '\'') text.append("'\\'");  // ends the quotes, a quote, and they begin anew
    text.push_back(c);
  }
  text.push_back('\'');
  return text;
}

}  // namespace rigmap
