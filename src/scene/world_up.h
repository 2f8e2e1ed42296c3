// What told which way is up.
#pragma once

#include <string_view>

namespace rigmap {

// The inclinometer; the plane that most points lie on; the first camera's -y.
enum class WorldUp { kImu = 0, kGround = 1, kCamera = 2 };

constexpr std::string_view Name(WorldUp up) {
  return up == WorldUp::kImu ? "imu" : up == WorldUp::kGround ? "ground" : "camera";
}

}  // namespace rigmap
