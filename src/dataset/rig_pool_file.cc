#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <sstream>

#include "core/error.h"
#include "dataset/internal/rig_nodes.h"
#include "dataset/rig_file.h"

namespace rigmap {
namespace {

std::vector<std::string> ReadFrames(const YamlNode& node) {
  std::vector<std::string> frames;
  std::istringstream words(node.AsString());
  for (std::string word; words >> word;) {
    if (word.find_first_not_of("0123456789abcdef") != std::string::npos) {
      throw DataError(
          fmt::format("{}: expected keys of frames, hexadecimal, found '{}'", node.where, word));
    }
    frames.push_back(std::move(word));
  }
  return frames;
}

RigWithoutPart ReadWithoutPart(const YamlNode& node) {
  node.RequireKeys({"frames", "correction", "covariance"});
  RigWithoutPart part{.frames = ReadFrames(node.At("frames"))};
  part.correction =
      CalibrationVector(node.At("correction").AsDoubles(std::size_t{kCalibrationSize}).data());
  if (const YamlNode* covariance = node.Find("covariance")) {
    part.covariance = ReadCovariance(*covariance);
  }
  return part;
}

RigPool ReadPool(const YamlNode& node, const std::filesystem::path& path) {
  node.RequireKeys({"start", "parts"});
  const YamlNode& start = node.At("start");
  start.RequireKeys(
      {"left", "right", "right_from_left", "antenna_in_left", "imu_from_left", "wheels", "sigmas"});
  RigPool pool{.start = ReadRigNode(start, path)};
  const YamlNode& parts = node.At("parts");
  if (parts.kind != YamlNode::Kind::kSequence) {
    throw DataError(fmt::format("{}: expected a list of parts", parts.where));
  }
  for (const YamlNode& part : parts.items) pool.parts.push_back(ReadWithoutPart(part));
  return pool;
}

PooledRig ReadRoot(const YamlNode& root, const std::filesystem::path& path) {
  PooledRig read{ReadRigNode(root, path), std::nullopt};
  if (const YamlNode* pool = root.Find("pool")) read.pool = ReadPool(*pool, path);
  return read;
}

std::string Indented(const std::string& text, const std::string& by) {
  std::string indented;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) indented += by + line + "\n";
  return indented;
}

// A few to a line.
std::string FormatFrames(const std::vector<std::string>& frames) {
  constexpr std::size_t kPerLine = 6;
  std::string text = frames.empty() ? " \"\"\n" : "\n";
  for (std::size_t i = 0; i < frames.size(); i += kPerLine) {
    const auto end = frames.begin() + static_cast<int>(std::min(i + kPerLine, frames.size()));
    text += fmt::format("        {}\n", fmt::join(frames.begin() + static_cast<int>(i), end, " "));
  }
  return text;
}

std::string FormatPool(const RigPool& pool) {
  std::string text =
      fmt::format("pool:\n  start:\n{}  parts:\n", Indented(WriteRigFile(pool.start), "    "));
  for (const RigWithoutPart& part : pool.parts) {
    text += fmt::format("    - frames:{}      correction: [{}]\n", FormatFrames(part.frames),
                        fmt::join(part.correction, ", "));
    if (part.covariance) {
      text += fmt::format("      covariance: {}\n", FormatCovariance(*part.covariance));
    }
  }
  return text;
}

}  // namespace

PooledRig ReadPooledRigFile(const std::filesystem::path& path) {
  return ReadRoot(ReadYaml(path), path);
}

PooledRig ParsePooledRigFile(const std::string& text, const std::filesystem::path& name) {
  return ReadRoot(ParseYaml(text, name.string()), name);
}

std::string WritePooledRigFile(const PooledRig& rig) {
  return WriteRigFile(rig.rig) + (rig.pool ? FormatPool(*rig.pool) : "");
}

StereoRig ReadRigFile(const std::filesystem::path& path) { return ReadPooledRigFile(path).rig; }

StereoRig ParseRigFile(const std::string& text, const std::filesystem::path& name) {
  return ParsePooledRigFile(text, name).rig;
}

}  // namespace rigmap
