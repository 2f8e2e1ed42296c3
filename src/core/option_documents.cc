#include "core/option_documents.h"

#include <fmt/format.h>

#include <sstream>

namespace rigmap {
namespace {

constexpr std::size_t kColumns = 100;

// The words of `text` in lines of at most kColumns, each after `indent`; a longer word has a line
// of its own.
std::string Wrap(const std::string& text, const std::string& indent) {
  std::istringstream words(text);
  std::string lines, line;
  for (std::string word; words >> word;) {
    if (!line.empty() && indent.size() + line.size() + 1 + word.size() > kColumns) {
      lines += fmt::format("{}{}\n", indent, line);
      line.clear();
    }
    if (!line.empty()) line += ' ';
    line += word;
  }
  return line.empty() ? lines : fmt::format("{}{}{}\n", lines, indent, line);
}

std::string UnitAndAllowed(const OptionField& field) {
  return field.unit.empty() ? AllowedText(field)
                            : fmt::format("{}; {}", field.unit, AllowedText(field));
}

// A cell of a table in Markdown.
std::string Cell(const std::string& text) {
  std::string cell;
  for (const char letter : text) {
    if (letter == '|') cell += '\\';
    cell += letter;
  }
  return cell;
}

}  // namespace

std::string OptionsYaml(const std::string& preamble, const std::vector<OptionSection>& sections) {
  std::string text = Wrap(preamble, "# ");
  for (const OptionSection& section : sections) {
    text += fmt::format("\n{}{}:\n", Wrap(section.about, "# "), section.name);
    for (const OptionField& field : section.fields) {
      text += Wrap(fmt::format("({}) {}", UnitAndAllowed(field), field.reason), "  # ");
      text += WriteOptions({field});
    }
  }
  return text;
}

std::string OptionsMarkdown(const std::string& preamble,
                            const std::vector<OptionSection>& sections) {
  std::string text = preamble;
  for (const OptionSection& section : sections) {
    text += fmt::format("\n## {}\n", section.name) + Wrap(section.about, "");
    text += "\n| option | default | unit | allowed | why |\n|---|---|---|---|---|\n";
    for (const OptionField& field : section.fields) {
      text += fmt::format("| `{}` | {} | {} | {} | {} |\n", field.name, OptionValueText(field),
                          Cell(field.unit), Cell(AllowedText(field)), Cell(field.reason));
    }
  }
  return text;
}

std::string OptionsHelp(const std::vector<OptionSection>& sections) {
  std::string text;
  for (const OptionSection& section : sections) {
    std::string options = section.name + ":";
    for (const OptionField& field : section.fields) {
      options += fmt::format(" {}={}", field.name, OptionValueText(field));
    }
    text += Wrap(options, "  ");
  }
  return text;
}

}  // namespace rigmap
