#include "workflows/recipes.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"

namespace rigmap {
namespace {

using Recipe = StageGraph (*)(const Dataset&, const DatasetContent&, const PartOptions&);
// In the order of the enumeration.
constexpr std::array<Recipe, 9> kRecipes{RigRecipe,      ColmapRecipe, SfmRecipe,
                                         CombinedRecipe, IcpRecipe,    VisualOdometryRecipe,
                                         KltRecipe,      WheelsRecipe, FilterRecipe};
static_assert(kRecipes.size() == NamesOf(Technique{}).size());

}  // namespace

Technique ParseTechnique(const std::string& name, const char* option) {
  constexpr auto kNames = NamesOf(Technique{});
  const auto found = std::ranges::find(kNames, name);
  if (found != kNames.end()) return static_cast<Technique>(found - kNames.begin());
  throw UsageError(
      fmt::format("{}: expected one of {}, found '{}'", option, fmt::join(kNames, ", "), name));
}

StageGraph MakeRecipe(Technique technique, const Dataset& dataset, const DatasetContent& content,
                      const PartOptions& options) {
  return kRecipes[static_cast<std::size_t>(technique)](dataset, content, options);
}

std::vector<std::string> KnownOutputs() {
  std::vector<std::string> outputs;
  for (const Recipe recipe : kRecipes) {
    for (std::string& output : recipe({}, {}, {}).Outputs()) {
      outputs.push_back(std::move(output));
    }
  }
  std::ranges::sort(outputs);
  const auto repeated = std::ranges::unique(outputs);
  outputs.erase(repeated.begin(), repeated.end());
  return outputs;
}

std::vector<std::string> StageNames(Technique technique) {
  return MakeRecipe(technique, {}, {}, {}).StageNames();
}

}  // namespace rigmap
