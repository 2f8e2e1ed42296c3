#include "workflows/shell_word.h"

#include <gtest/gtest.h>

#include <cstdio>

namespace rigmap {
namespace {

std::string ReadByShell(const std::string& word) {
  const std::string command = "printf %s " + ShellWord(word);
  std::FILE* shell = popen(command.c_str(), "r");
  std::string text;
  for (int c = std::fgetc(shell); c != EOF; c = std::fgetc(shell)) {
    text.push_back(static_cast<char>(c));
  }
  EXPECT_EQ(pclose(shell), 0) << command;
  return text;
}

TEST(ShellWord, IsReadAsItWasByAShell) {
  for (const char* word : {"part", "--out=a/b_1.5", "two words", "it's", "", "$HOME", "a;b", "*",
                           "\"", "~", "#", "back\\slash", "line\nline", "'", "\xC3\xA9t\xC3\xA9"}) {
    EXPECT_EQ(ReadByShell(word), word);
  }
  EXPECT_EQ(ShellWord("--set"), "--set");
  EXPECT_EQ(ShellWord("two words"), "'two words'");
}

}  // namespace
}  // namespace rigmap
