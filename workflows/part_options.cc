#include "workflows/part_options.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"

namespace rigmap {
namespace {

using Sections = std::vector<OptionSection>;

const OptionFields* FindSection(const Sections& sections, const std::string& name) {
  const auto it = std::find_if(sections.begin(), sections.end(),
                               [&](const OptionSection& section) { return section.name == name; });
  return it == sections.end() ? nullptr : &it->fields;
}

std::string Names(const Sections& sections) {
  std::vector<std::string> names;
  for (const auto& section : sections) names.push_back(section.name);
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

std::vector<OptionSection> PartOptions::Sections() {
  return {
      {"masks",
       "Which pixels are used at all. Beside these, the rig file may name a mask and a calibrated "
       "region.",
       masks.Fields()},
      {"features", "Keypoints of the left images and their stereo matches in the right ones.",
       features.Fields()},
      {"klt",
       "Corners followed from frame to frame: by the technique klt, and where keypoints lose the "
       "way.",
       corners.Fields()},
      {"odometry", "Motion from frame to keyframe.", odometry.Fields()},
      {"dead_reckoning", "Motion by wheels, gyro and inclinometer: what is known of these.",
       dead_reckoning.Fields()},
      {"filter", "These fused with the motion from frame to keyframe.", filter.Fields()},
      {"matching", "Verified correspondences between keyframes.", matching.Fields()},
      {"colmap", "The program COLMAP, as the stages database and mapping run it.", colmap.Fields()},
      {"mapping", "COLMAP's incremental mapping, and what the stage database gives it.",
       JoinFields({mapping.Fields(), keyframe_graph.Fields()})},
      {"sfm",
       "Structure from motion with COLMAP's own matches, of the techniques sfm and combined.",
       JoinFields({free_matching.Fields(), free_mapping.Fields()})},
      {"scale", "Metres, from the distances between left and right cameras.", scale.Fields()},
      {"adjustment", "Bundle adjustment with one pose per frame and the rig held.",
       adjustment.Fields()},
      {"registration", "Clouds of single frames, chained by ICP (technique icp) and merged.",
       JoinFields({registration.Fields(), clouds.Fields(), merging.Fields()})},
      {"dense", "Depth of keyframes, and of frames between them where more passes.",
       JoinFields({dense.Fields(), depth_maps.Fields()})},
      {"fusion", "Depth maps to one surface.", JoinFields({voxel.Fields(), fusion.Fields()})},
      {"raster",
       "Height map, ortho-image, terrain and pictures of the surface. Cells are fusion's voxels.",
       JoinFields({raster.Fields(), terrain.Fields(), pictures.Fields()})},
      {"evaluation", "Comparison with a truth, where there is one.", evaluation.Fields()},
      {"georeference",
       "The trajectory laid on satellite fixes, where there are any, to judge it and to give "
       "finished "
       "products coordinates of the Earth. No pose and no shape depends on it.",
       JoinFields({georeference.Fields(), earth.Fields(), las.Fields()})},
      {"rocks", "Rocks found in the map, and surveyed ones.",
       JoinFields({rocks.Fields(), rock_survey.Fields()})},
      {"gates",
       "Limits beyond which a result is not to be trusted (exit code 3): most that a value may be, "
       "but for registered. A gate that does not apply passes. No gate sees an error in the length "
       "of the baseline.",
       gates.Fields()}};
}

void PartOptions::Validate() const {
  PartOptions copy = *this;
  for (const OptionSection& section : copy.Sections()) {
    RequireInRange(section.name, section.fields);
  }
  matching.RequireRelations();
  clouds.RequireRelations();
  dense.RequireRelations();
  fusion.RequireRelations();
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

std::vector<std::string> ListChangedOptions(PartOptions options,
                                            const std::vector<std::string>& named) {
  PartOptions defaults;
  const auto sections = options.Sections(), default_sections = defaults.Sections();
  std::vector<std::string> changed;
  for (std::size_t i = 0; i < sections.size(); ++i) {
    for (std::size_t k = 0; k < sections[i].fields.size(); ++k) {
      const OptionField& field = sections[i].fields[k];
      const std::string name = fmt::format("{}.{}", sections[i].name, field.name);
      const std::string value = OptionValueText(field);
      if (value == OptionValueText(default_sections[i].fields[k]) &&
          std::ranges::find(named, name) == named.end()) {
        continue;
      }
      changed.push_back(fmt::format("{}={}", name, value));
    }
  }
  return changed;
}

std::string WritePartOptions(PartOptions options) {
  std::string text;
  for (const OptionSection& section : options.Sections()) {
    text += section.name + ":\n" + WriteOptions(section.fields);
  }
  return text;
}

}  // namespace rigmap
