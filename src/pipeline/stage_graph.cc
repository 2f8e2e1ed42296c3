#include "pipeline/stage_graph.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace rigmap {

std::size_t StageGraph::Add(StageNode node) {
  for (const std::size_t input : node.inputs) {
    if (input >= nodes_.size()) {
      throw std::logic_error(fmt::format("{} takes what is not in the graph", node.name));
    }
  }
  nodes_.push_back(std::move(node));
  return nodes_.size() - 1;
}

std::vector<std::string> StageGraph::StageNames() const {
  std::vector<std::string> names;
  for (const StageNode& node : nodes_) {
    const bool said = node.kind == StageNode::Kind::kSource && node.report;
    if (node.kind == StageNode::Kind::kStage || said) names.push_back(node.name);
  }
  return names;
}

std::vector<std::string> StageGraph::Outputs() const {
  std::vector<std::string> outputs;
  for (const StageNode& node : nodes_) {
    outputs.insert(outputs.end(), node.publishes.begin(), node.publishes.end());
  }
  return outputs;
}

std::size_t StageGraph::IndexOf(const std::string& name) const {
  const auto found = std::ranges::find(nodes_, name, &StageNode::name);
  if (found == nodes_.end()) throw std::logic_error(fmt::format("no stage is named {}", name));
  return static_cast<std::size_t>(found - nodes_.begin());
}

std::vector<std::size_t> StageGraph::Needs(std::size_t index) const {
  std::vector<std::size_t> needs = nodes_[index].inputs;
  for (std::size_t n = 0; n < needs.size(); ++n) {
    if (nodes_[needs[n]].kind != StageNode::Kind::kView) continue;
    const std::vector<std::size_t> of_view = nodes_[needs[n]].inputs;
    needs.insert(needs.end(), of_view.begin(), of_view.end());
  }
  return needs;
}

std::vector<bool> StageGraph::Ancestors(std::size_t index) const {
  std::vector<bool> reached(nodes_.size(), false);
  reached[index] = true;
  for (std::size_t i = index + 1; i-- > 0;) {
    if (!reached[i]) continue;
    for (const std::size_t input : nodes_[i].inputs) reached[input] = true;
  }
  return reached;
}

std::vector<bool> StageGraph::Descendants(std::size_t index) const {
  std::vector<bool> reached(nodes_.size(), false);
  reached[index] = true;
  for (std::size_t i = index + 1; i < nodes_.size(); ++i) {
    reached[i] =
        std::ranges::any_of(nodes_[i].inputs, [&](std::size_t input) { return reached[input]; });
  }
  return reached;
}

}  // namespace rigmap
