// Options as people read them. All texts show the values that the fields have.
#pragma once

#include <string>
#include <vector>

#include "core/options.h"

namespace rigmap {

// A YAML file: each option under a comment with unit, what is allowed and the reason. `preamble` is
// the comment at its top.
std::string OptionsYaml(const std::string& preamble, const std::vector<OptionSection>& sections);

// A page of Markdown: a table for each section. `preamble` is Markdown.
std::string OptionsMarkdown(const std::string& preamble,
                            const std::vector<OptionSection>& sections);

// A line or more per section, "section: option=value option=value".
std::string OptionsHelp(const std::vector<OptionSection>& sections);

}  // namespace rigmap
