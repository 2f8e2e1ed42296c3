// Shares of a rig file, between the files that read and write it.
#pragma once

#include <filesystem>
#include <string>

#include "core/yaml.h"
#include "scene/rig.h"

namespace rigmap {

// Of a rig file's top level; a key `pool` is passed over. `path` is what masks are relative to.
StereoRig ReadRigNode(const YamlNode& root, const std::filesystem::path& path);

// Of the key `wheels`, and back.
RoverWheels ReadWheelsNode(const YamlNode& node);
std::string FormatWheels(const RoverWheels& rover);

// Of the key `sigmas`, into the rig.
void ReadSigmasNode(const YamlNode& node, StereoRig& rig);

// Of its upper triangle, row by row; must be positive definite.
CalibrationMatrix ReadCovariance(const YamlNode& node);
// "[...]" as ReadCovariance takes it.
std::string FormatCovariance(const CalibrationMatrix& covariance);

}  // namespace rigmap
