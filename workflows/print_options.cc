#include "workflows/print_options.h"

#include <fmt/format.h>

#include "core/error.h"
#include "core/option_documents.h"
#include "workflows/part_options.h"

namespace rigmap {
namespace {

constexpr const char* kYamlPreamble =
    "Every option of `rigmap part` with its default, as `rigmap options` prints it. A file given "
    "with --config, or a single --set section.option=value, need name only what differs; an "
    "unknown name is an error. The values a run used are written to config.yaml in its output "
    "folder. The options of a stage stand in the section of its name; `masks` serve features and "
    "dense, `colmap` database and mapping, `gates` judge the result. In brackets: the unit, if "
    "any, and what is allowed. px are pixels of the input images; a sigma is one standard "
    "deviation.";

constexpr const char* kMarkdownPreamble =
    R"(# Options of `rigmap part`

Made by `rigmap options --format markdown` from the declarations in the code: not edited by hand. Set
one option with `--set section.option=value`, several with `--config FILE` in the form of
[config/default.yaml](../config/default.yaml). The values a run used are in `config.yaml` of its
output folder. px are pixels of the input images; a sigma is one standard deviation.
)";

}  // namespace

std::string PrintOptions(const std::string& format) {
  PartOptions defaults;
  if (format == NameOf(OptionsFormat::kYaml)) {
    return OptionsYaml(kYamlPreamble, defaults.Sections());
  }
  if (format == NameOf(OptionsFormat::kMarkdown)) {
    return OptionsMarkdown(kMarkdownPreamble, defaults.Sections());
  }
  throw UsageError(fmt::format("--format: expected {}, found '{}'",
                               fmt::join(NamesOf(OptionsFormat{}), " or "), format));
}

std::string PartOptionsHelp() {
  PartOptions defaults;
  return "Options for --set and --config; `rigmap options` prints each with unit, range and "
         "reason:\n" +
         OptionsHelp(defaults.Sections());
}

}  // namespace rigmap
