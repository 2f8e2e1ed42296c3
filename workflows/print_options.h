// All options of `rigmap part` with their defaults, as text: config/default.yaml, docs/options.md.
#pragma once

#include <array>
#include <string>

namespace rigmap {

enum class OptionsFormat { kYaml, kMarkdown };
constexpr auto NamesOf(OptionsFormat) { return std::array{"yaml", "markdown"}; }

// config/default.yaml or docs/options.md, byte for byte. Throws UsageError for an unknown format.
std::string PrintOptions(const std::string& format);

// Each option with its default, for --help.
std::string PartOptionsHelp();

}  // namespace rigmap
