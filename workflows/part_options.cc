#include "workflows/part_options.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"

namespace rigmap {
namespace {

using Sections = std::vector<std::pair<std::string, OptionFields>>;

const OptionFields* FindSection(const Sections& sections, const std::string& name) {
  const auto it = std::find_if(sections.begin(), sections.end(),
                               [&](const auto& section) { return section.first == name; });
  return it == sections.end() ? nullptr : &it->second;
}

std::string Names(const Sections& sections) {
  std::vector<std::string> names;
  for (const auto& section : sections) names.push_back(section.first);
  return fmt::format("{}", fmt::join(names, ", "));
}

void ReadConfig(const std::filesystem::path& path, const Sections& sections) {
  const YamlNode file = ReadYaml(path);
  if (file.kind != YamlNode::Kind::kMap && file.kind != YamlNode::Kind::kNull) {
    throw DataError(
        fmt::format("{}: expected sections with options, found something else", file.where));
  }
  for (const auto& [name, section] : file.entries) {
    const OptionFields* fields = FindSection(sections, name);
    if (!fields) {
      throw DataError(fmt::format("{}: unknown section '{}', expected one of {}", section.where,
                                  name, Names(sections)));
    }
    ReadOptions(section, *fields);
  }
}

void Assign(const std::string& assignment, const Sections& sections) {
  const auto equals = assignment.find('=');
  const auto point = assignment.find('.');
  if (equals == std::string::npos || point == std::string::npos || point > equals) {
    throw UsageError(fmt::format("--set: expected stage.option=value, found '{}'", assignment));
  }
  const std::string stage = assignment.substr(0, point);
  const OptionFields* fields = FindSection(sections, stage);
  if (!fields) {
    throw UsageError(fmt::format("--set {}: unknown section '{}', expected one of {}", assignment,
                                 stage, Names(sections)));
  }
  SetOption(stage, assignment.substr(point + 1, equals - point - 1), assignment.substr(equals + 1),
            *fields);
}

}  // namespace

std::vector<std::pair<std::string, OptionFields>> PartOptions::Sections() {
  return {{"masks", masks.Fields()},
          {"features", features.Fields()},
          {"odometry", odometry.Fields()},
          {"matching", matching.Fields()},
          {"colmap", colmap.Fields()},
          {"mapping", JoinFields({mapping.Fields(), keyframe_graph.Fields()})},
          {"scale", scale.Fields()},
          {"adjustment", adjustment.Fields()},
          {"dense", dense.Fields()},
          {"fusion", JoinFields({voxel.Fields(), fusion.Fields()})},
          {"raster", JoinFields({raster.Fields(), pictures.Fields()})},
          {"evaluation", evaluation.Fields()},
          {"georeference", georeference.Fields()},
          {"rocks", JoinFields({rocks.Fields(), rock_survey.Fields()})},
          {"gates", gates.Fields()}};
}

void PartOptions::Validate() const {
  masks.Validate();
  features.Validate();
  odometry.Validate();
  matching.Validate();
  colmap.Validate();
  mapping.Validate();
  keyframe_graph.Validate();
  scale.Validate();
  adjustment.Validate();
  dense.Validate();
  voxel.Validate();
  fusion.Validate();
  raster.Validate();
  pictures.Validate();
  evaluation.Validate();
  georeference.Validate();
  rocks.Validate();
  rock_survey.Validate();
  gates.Validate();
}

PartOptions LoadPartOptions(const std::optional<std::filesystem::path>& config,
                            const std::vector<std::string>& assignments) {
  PartOptions options;
  const auto sections = options.Sections();
  if (config) ReadConfig(*config, sections);
  for (const std::string& assignment : assignments) Assign(assignment, sections);
  options.Validate();
  return options;
}

std::string WritePartOptions(PartOptions options) {
  std::string text;
  for (const auto& [name, fields] : options.Sections()) {
    text += name + ":\n" + WriteOptions(fields);
  }
  return text;
}

}  // namespace rigmap
