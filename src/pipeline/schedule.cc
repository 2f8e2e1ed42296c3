#include "pipeline/internal/schedule.h"

#include <algorithm>
#include <iterator>
#include <set>

#include "core/artefact.h"

namespace rigmap {
namespace {

using Kind = StageNode::Kind;

std::vector<bool> Selected(const StageGraph& graph, const std::optional<std::string>& until) {
  const auto& nodes = graph.nodes();
  std::vector<bool> selected(nodes.size(), true);
  if (until) selected = graph.Ancestors(graph.IndexOf(*until));
  // Views cost nothing, so what a check takes may be one that no stage asked for.
  std::vector<bool> there = selected;
  const auto are_there = [&](const StageNode& node) {
    return std::ranges::all_of(node.inputs, [&](auto in) { return there[in]; });
  };
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (nodes[i].kind == Kind::kView) there[i] = there[i] || are_there(nodes[i]);
    if (nodes[i].kind == Kind::kCheck) there[i] = selected[i] = are_there(nodes[i]);
  }
  for (std::size_t i = nodes.size(); i-- > 0;) {
    if (!selected[i]) continue;
    for (const std::size_t input : nodes[i].inputs) selected[input] = true;
  }
  return selected;
}

// Of a source that nobody asks for now: as it was when somebody did.
std::optional<std::string> RecordedKey(const StageNode& source, const Ledger& ledger) {
  const StageRecord* record = ledger.Find(source.name);
  return record ? std::optional(record->key) : std::nullopt;
}

std::optional<std::string> DerivedKey(const StageNode& node,
                                      const std::vector<std::optional<std::string>>& keys) {
  std::string text = node.identity;
  for (const std::size_t input : node.inputs) {
    if (!keys[input]) return std::nullopt;
    text += *keys[input] + "\n";
  }
  return HashText(text);
}

}  // namespace

Schedule MakeSchedule(const StageGraph& graph, const RunPlan& plan, const Ledger& ledger) {
  const auto& nodes = graph.nodes();
  Schedule schedule;
  schedule.selected = Selected(graph, plan.until);
  schedule.anew.assign(nodes.size(), false);
  if (plan.from) schedule.anew = graph.Descendants(graph.IndexOf(*plan.from));
  schedule.keys.resize(nodes.size());
  schedule.sources.resize(nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    schedule.anew[i] = schedule.anew[i] && schedule.selected[i];
    if (nodes[i].kind != Kind::kSource) {
      schedule.keys[i] = DerivedKey(nodes[i], schedule.keys);
    } else if (schedule.selected[i]) {
      auto [key, value] = nodes[i].open();
      schedule.keys[i] = HashText(nodes[i].name + "\n" + key);
      schedule.sources[i] = std::move(value);
    } else {
      schedule.keys[i] = RecordedKey(nodes[i], ledger);
    }
  }
  return schedule;
}

Outdated FindOutdated(const StageGraph& graph, const Schedule& schedule, const Ledger& ledger,
                      const std::vector<std::string>& known_outputs,
                      const std::filesystem::path& root) {
  Outdated outdated;
  std::set<std::string> spoken_for;
  const auto& nodes = graph.nodes();
  for (const StageRecord& record : ledger.stages) {
    const auto found = std::ranges::find(nodes, record.name, &StageNode::name);
    const auto index = static_cast<std::size_t>(found - nodes.begin());
    const bool holds = found != nodes.end() && !schedule.anew[index] &&
                       (!schedule.keys[index] || *schedule.keys[index] == record.key);
    if (holds) {
      // What the stage published in another recipe is this recipe's only where it does so here.
      std::ranges::copy_if(record.published, std::inserter(spoken_for, spoken_for.end()),
                           [&](const std::string& output) {
                             return std::ranges::count(found->publishes, output) > 0;
                           });
    } else {
      outdated.stages.push_back(record.name);
    }
  }
  for (const std::string& output : known_outputs) {
    std::error_code ignored;
    if (!spoken_for.contains(output) && std::filesystem::exists(root / output, ignored)) {
      outdated.outputs.push_back(output);
    }
  }
  return outdated;
}

}  // namespace rigmap
