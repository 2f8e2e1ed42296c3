// Shares of a rig file, between the files that read and write it.
#pragma once

#include <filesystem>
#include <string>

#include "core/error.h"
#include "core/yaml.h"
#include "scene/rig.h"

namespace rigmap {

// What is wrong, after the file and line where it stands.
DataError RigComplaint(const YamlNode& node, const std::string& what);

// Of a rig file's top level; a key `pool` is passed over. `path` is what masks are relative to.
StereoRig ReadRigNode(const YamlNode& root, const std::filesystem::path& path);

// A motion `{R, t}`, and a point in metres; from the left camera, no vehicle is that large.
Rigid3 ReadRigid(const YamlNode& node);
Eigen::Vector3d ReadLever(const YamlNode& node);
// Throw DataError where the motion between the eyes is none of a rig in metres, or is not as
// stated.
void CheckBaseline(const YamlNode& root, const StereoRig& rig);
void CheckRectified(const YamlNode& root, const Rigid3& right_from_left);

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
