// Calibrations that are off: what a rig file says apart from what the rig is.
#pragma once

#include <span>
#include <string>

#include "scene/rig.h"

namespace rigmap {

// `specs` are words NAME=VALUE as DescribeRigErrorNames lists them; given twice, a name counts
// twice. Throws UsageError for an unknown name (listing all) and a value that is no number, or out
// of its range.
StereoRig WithRigErrors(const StereoRig& rig, std::span<const std::string> specs);

// One line per name, for --help.
std::string DescribeRigErrorNames();

}  // namespace rigmap
