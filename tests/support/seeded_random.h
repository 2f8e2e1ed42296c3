// Random numbers for tests, seeded by the running test's name: every run of a test is the same.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <numbers>
#include <random>
#include <string>

#include "geometry/rigid3.h"

namespace rigmap {

class SeededRandom {
 public:
  SeededRandom() {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    const std::string name = std::string(info->test_suite_name()) + "." + info->name();
    std::seed_seq seed(name.begin(), name.end());
    engine_.seed(seed);
  }

  // In [low, high).
  double Uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_()) / 4294967296.0);
  }
  // By adding twelve uniform numbers: the same with every standard library.
  double Normal(double sigma) {
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) sum += Uniform(0.0, 1.0);
    return sigma * sum;
  }
  // Each coordinate in [-reach, reach).
  Eigen::Vector3d Vector(double reach) {
    const double x = Uniform(-reach, reach), y = Uniform(-reach, reach);
    return {x, y, Uniform(-reach, reach)};
  }
  Eigen::Vector3d Noise(double sigma) {
    const double x = Normal(sigma), y = Normal(sigma);
    return {x, y, Normal(sigma)};
  }
  // About a random axis by up to `max_angle_rad`.
  Eigen::Quaterniond Rotation(double max_angle_rad = std::numbers::pi) {
    Eigen::Vector3d axis = Vector(1.0);
    while (axis.norm() < 0.1) axis = Vector(1.0);
    return Eigen::Quaterniond(Eigen::AngleAxisd(Uniform(0.0, max_angle_rad), axis.normalized()));
  }
  Rigid3 Motion(double reach_m, double max_angle_rad = std::numbers::pi) {
    const Eigen::Quaterniond rotation = Rotation(max_angle_rad);
    return {rotation, Vector(reach_m)};
  }
  Sim3 Similarity(double reach) {
    const Eigen::Quaterniond rotation = Rotation();
    const double scale = Uniform(0.1, 10.0);
    return {scale, rotation, Vector(reach)};
  }

 private:
  std::mt19937 engine_;
};

}  // namespace rigmap
