#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/error.h"
#include "dataset/internal/rig_nodes.h"

namespace rigmap {
namespace {

constexpr int kDrives = 6, kSteeringJoints = 4;

// Counted from 1; 0: none.
std::optional<int> SteeringJoint(const YamlNode& node, double number) {
  const int joint = static_cast<int>(number);
  if (joint != number || joint < 0 || joint > kSteeringJoints) {
    throw RigComplaint(node, fmt::format("expected steering joints 1 to {}, or 0 for a wheel that "
                                         "is not steered, found {}",
                                         kSteeringJoints, number));
  }
  return joint > 0 ? std::optional(joint - 1) : std::nullopt;
}

}  // namespace

RoverWheels ReadWheelsNode(const YamlNode& node) {
  node.RequireKeys({"radius_m", "contacts_in_imu", "steered_by"});
  RoverWheels rover;
  if (const YamlNode* radius = node.Find("radius_m")) {
    rover.radius_m = radius->AsDouble();
    if (!(*rover.radius_m > 0.0)) {
      throw RigComplaint(*radius,
                         fmt::format("expected metres above 0, found {}", *rover.radius_m));
    }
  }
  const auto contacts = node.At("contacts_in_imu").AsDoubles(3 * kDrives);
  const YamlNode& steered = node.At("steered_by");
  const auto joints = steered.AsDoubles(kDrives);
  for (std::size_t i = 0; i < kDrives; ++i) {
    rover.wheels.push_back(
        {Eigen::Vector3d(contacts.data() + 3 * i), SteeringJoint(steered, joints[i])});
  }
  return rover;
}

std::string FormatWheels(const RoverWheels& rover) {
  std::vector<double> contacts;
  std::vector<int> joints;
  for (const RoverWheel& wheel : rover.wheels) {
    const double* const x = wheel.contact_in_imu.data();
    contacts.insert(contacts.end(), x, x + 3);
    joints.push_back(wheel.steering ? *wheel.steering + 1 : 0);
  }
  std::string text = "wheels:\n";
  if (rover.radius_m) text += fmt::format("  radius_m: {}\n", *rover.radius_m);
  return text + fmt::format("  contacts_in_imu: [{}]\n  steered_by: [{}]\n",
                            fmt::join(contacts, ", "), fmt::join(joints, ", "));
}

}  // namespace rigmap
