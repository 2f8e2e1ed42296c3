#include "workflows/print_stages.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace rigmap {
namespace {

using Kind = StageNode::Kind;

std::string Listed(const std::vector<std::string>& names) {
  std::vector<std::string> quoted;
  for (const std::string& name : names) quoted.push_back(fmt::format("`{}`", name));
  return fmt::format("{}", fmt::join(quoted, ", "));
}

void AddNamed(const StageGraph& graph, const StageNode& node, std::vector<std::string>& names) {
  for (const std::size_t input : node.inputs) {
    const StageNode& taken = graph.nodes()[input];
    if (taken.kind == Kind::kView) {
      AddNamed(graph, taken, names);
    } else if (std::ranges::find(names, taken.name) == names.end()) {
      names.push_back(taken.name);
    }
  }
}

std::vector<std::string> Taken(const StageGraph& graph, const StageNode& node) {
  std::vector<std::string> names;
  AddNamed(graph, node, names);
  return names;
}

// Of each section that is read: its name, with what is left out of it, or the options that are read
// where these are fewer.
std::string ReadOptionNames(const StageNode& node) {
  std::vector<std::string> phrases;
  PartOptions options;
  for (const OptionSection& section : options.Sections()) {
    std::vector<std::string> read, left_out;
    for (const OptionField& field : section.fields) {
      const std::string name = section.name + "." + field.name;
      (std::ranges::find(node.reads, name) != node.reads.end() ? read : left_out).push_back(name);
    }
    if (read.empty()) continue;
    if (left_out.size() >= read.size()) {
      phrases.push_back(Listed(read));
    } else {
      phrases.push_back(Listed({section.name}) +
                        (left_out.empty() ? "" : " but " + Listed(left_out)));
    }
  }
  return fmt::format("{}", fmt::join(phrases, ", "));
}

}  // namespace

std::string PrintStages(const StageGraph& graph) {
  std::string table =
      "| stage | takes | reads | makes | publishes |\n"
      "|---|---|---|---|---|\n";
  for (const StageNode& node : graph.nodes()) {
    if (node.kind != Kind::kStage && node.kind != Kind::kCheck) continue;
    table += fmt::format(
        "| {}`{}` | {} | {} | {} | {} |\n", node.kind == Kind::kCheck ? "check " : "", node.name,
        Listed(Taken(graph, node)), ReadOptionNames(node), node.about, Listed(node.publishes));
  }
  return table;
}

}  // namespace rigmap
