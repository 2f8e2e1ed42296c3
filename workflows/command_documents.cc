#include "workflows/command_documents.h"

#include <fmt/format.h>

#include <array>
#include <string_view>
#include <vector>

#include "workflows/recipes.h"

namespace rigmap {
namespace {

struct CommandExample {
  std::string_view command, line, does;
};

constexpr std::array kExamples{
    CommandExample{
        "part", "rigmap part --dataset drive --out result",
        "reconstructs a stereo folder; the same command again goes on from where it was"},
    CommandExample{"part", "rigmap part --dataset katwijk --traverse 3 --part 1 --out result",
                   "one part of a Katwijk root"},
    CommandExample{"part", "rigmap part --dataset drive --frames 0:16 --until adjustment --out try",
                   "the poses of the first sixteen pairs, quickly"},
    CommandExample{"part",
                   "rigmap part --dataset drive --rig pooled.yaml --accuracy 0.5 --out result",
                   "with another rig file, and good to 0.5 % or refused"},
    CommandExample{"run", "rigmap run --dataset katwijk --traverse 3 --out whole",
                   "all parts of a traverse, joined into one world"},
    CommandExample{"plan", "rigmap plan --dataset katwijk --traverse 3 --split 10",
                   "what the data are, and ten jobs of them"},
    CommandExample{"join", "rigmap join whole/parts/* --out whole",
                   "parts that were done elsewhere"},
    CommandExample{"evaluate", "rigmap evaluate result --truth truth/trajectory.tum",
                   "how far the result is from the truth"},
    CommandExample{"calibrate", "rigmap calibrate monday tuesday --rig-out pooled.yaml",
                   "one rig from what two drives say of it"},
    CommandExample{"compare",
                   "rigmap compare --dataset drive --techniques rig,vo,icp --out compared",
                   "three ways side by side"},
    CommandExample{"compare", "rigmap compare monday tuesday --out compared",
                   "finished results side by side"},
    CommandExample{"report", "rigmap report result compared", "writes report.html into both"},
    CommandExample{"options", "rigmap options > my.yaml",
                   "every option with its default, to be changed and given with --config"},
    CommandExample{"stages", "rigmap stages --technique vo", "what comes after what"}};

std::string ExamplesOf(std::string_view command) {
  std::string text;
  for (const CommandExample& example : kExamples) {
    if (example.command != command) continue;
    text += fmt::format("  {}\n      {}\n", example.line, example.does);
  }
  return text.empty() ? "" : "Examples:\n" + text;
}

std::vector<const CLI::App*> CommandsOf(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}

std::string LongName(const CLI::Option& option) {
  return option.get_lnames().empty() ? "" : "--" + option.get_lnames().front();
}

std::string TechniqueNames() {
  std::string names;
  for (const char* name : NamesOf(Technique{})) names += fmt::format("{} ", name);
  return names;
}

// In man's language a hyphen is to be said as one, and a line may not begin with a dot.
std::string Roff(std::string_view text) {
  std::string escaped;
  for (const char character : text) {
    if (character == '\\') {
      escaped += "\\e";
    } else if (character == '-') {
      escaped += "\\-";
    } else if ((character == '.' || character == '\'') &&
               (escaped.empty() || escaped.back() == '\n')) {
      escaped += std::string("\\&") + character;
    } else {
      escaped += character;
    }
  }
  return escaped;
}

std::string ManualOf(const CLI::App& command) {
  std::string text =
      fmt::format(".SS rigmap {}\n{}.\n", command.get_name(), Roff(command.get_description()));
  for (const CLI::Option* option : command.get_options()) {
    const std::string name = option->get_positional() ? option->get_name(true) : LongName(*option);
    if (name.empty()) continue;
    text += fmt::format(".TP\n.B {}\n{}\n", Roff(name), Roff(option->get_description()));
  }
  for (const CommandExample& example : kExamples) {
    if (example.command != command.get_name()) continue;
    text += fmt::format(".PP\n.B {}\n.br\n{}\n", Roff(example.line), Roff(example.does));
  }
  return text;
}

}  // namespace

void AddExamples(CLI::App& app) {
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; })) {
    const std::string examples = ExamplesOf(command->get_name());
    if (examples.empty()) continue;
    const std::string rest = command->get_footer();
    const std::string whole = rest.empty() ? examples : examples + "\n" + rest;
    // A footer that is a function is printed beside one that is text.
    command->footer([whole] { return whole; });
  }
}

std::string BashCompletion(const CLI::App& app) {
  std::string names, cases;
  for (const CLI::App* command : CommandsOf(app)) {
    names += command->get_name() + " ";
    cases += fmt::format("    {}) words=\"", command->get_name());
    for (const CLI::Option* option : command->get_options()) cases += LongName(*option) + " ";
    cases += "\" ;;\n";
  }
  return fmt::format(
      "# source <(rigmap completion); in zsh after: autoload bashcompinit && bashcompinit\n"
      "_rigmap() {{\n  local word=\"${{COMP_WORDS[COMP_CWORD]}}\" words=\n"
      "  if ((COMP_CWORD == 1)); then\n    COMPREPLY=($(compgen -W \"{}--help --version\" -- "
      "\"$word\"))\n    return\n  fi\n"
      "  case \"${{COMP_WORDS[COMP_CWORD - 1]}}\" in\n"
      "    --technique|--techniques) COMPREPLY=($(compgen -W \"{}\" -- \"$word\")); return ;;\n"
      "  esac\n  case \"${{COMP_WORDS[1]}}\" in\n{}  esac\n"
      "  if [[ \"$word\" == -* ]]; then\n    COMPREPLY=($(compgen -W \"$words\" -- \"$word\"))\n"
      "  else\n    COMPREPLY=($(compgen -f -- \"$word\"))\n  fi\n}}\n"
      "complete -o filenames -F _rigmap rigmap\n",
      names, TechniqueNames(), cases);
}

std::string ManualPage(const CLI::App& app) {
  std::string text = fmt::format(
      ".TH RIGMAP 1\n.SH NAME\nrigmap \\- {}\n.SH SYNOPSIS\n.B rigmap\n.I command\n[arguments]\n"
      ".SH DESCRIPTION\nMakes a metric trajectory and a metric, coloured map of the stereo images "
      "of a drive, and says whether they can be trusted. Every run ends with a report: open "
      "report.html in its output folder.\n.SH COMMANDS\n",
      Roff(app.get_description()));
  for (const CLI::App* command : CommandsOf(app)) text += ManualOf(*command);
  return text +
         ".SH EXIT STATUS\n.TP\n.B 0\nDone, consistent, and as good as asked.\n"
         ".TP\n.B 1\nFailed; the last line of standard error says why.\n"
         ".TP\n.B 2\nWrong usage.\n"
         ".TP\n.B 3\nEverything was written, but it is not to be trusted or not as good as "
         "asked.\n";
}

}  // namespace rigmap
