#include "dataset/dataset_content.h"

#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>

#include <iterator>

#include "core/artefact.h"
#include "dataset/rig_file.h"

namespace rigmap {

std::string DatasetContent::Key() const {
  return HashText(fmt::format("{}\n{}\n{}{}{}", rig, FramesKey(), inclinometer, sensors, lone));
}

std::string DatasetContent::FramesKey() const {
  return HashText(fmt::format("{}", fmt::join(frames, "\n")));
}

StereoRig WithoutMasks(const StereoRig& rig) {
  StereoRig values = rig;
  values.left.mask_path.clear();
  values.right.mask_path.clear();
  return values;
}

std::string DescribeRig(const StereoRig& rig) { return WriteRigFile(WithoutMasks(rig)); }

std::string HashRig(const Dataset& dataset, FileHashes& hashes) {
  std::string rig = WritePooledRigFile({WithoutMasks(dataset.rig), dataset.rig_pool});
  for (const Eye eye : kEyes) {
    const std::string& mask_path = dataset.rig.Of(eye).mask_path;
    rig += mask_path.empty() ? "no mask\n" : hashes.Hash(mask_path) + "\n";
  }
  return HashText(rig);
}

namespace {

std::string HashSensors(const Dataset& dataset) {
  // Of a record that is not to be used nothing matters.
  const auto& [wheels, wheel_problem] = dataset.wheels;
  const auto& [inertial, inertial_problem] = dataset.inertial;
  if (wheels.empty() && inertial.empty()) return {};
  std::string text;
  const auto to = std::back_inserter(text);
  for (const WheelSample& sample : wheels) {
    if (!wheel_problem.empty()) break;
    fmt::format_to(to, "{} {} {} {}\n", sample.stamp_ns, fmt::join(sample.drive_angle_rad, " "),
                   fmt::join(sample.drive_rate_radps, " "), fmt::join(sample.steering_rad, " "));
  }
  for (const InertialSample& sample : inertial) {
    if (!inertial_problem.empty()) break;
    const Eigen::Vector3d &w = sample.angular_rate_radps, &up = sample.inclination_mps2;
    fmt::format_to(to, "{} {} {} {} {} {} {}\n", sample.stamp_ns, w.x(), w.y(), w.z(), up.x(),
                   up.y(), up.z());
  }
  return HashText(text);
}

}  // namespace

DatasetContent HashContent(const Dataset& dataset, FileHashes& hashes) {
  DatasetContent content;
  content.rig = HashRig(dataset, hashes);
  content.frames.resize(dataset.frames.size());
  content.images.resize(dataset.frames.size());
  tbb::parallel_for(std::size_t{0}, dataset.frames.size(), [&](std::size_t i) {
    const StereoFrame& frame = dataset.frames[i];
    const std::string left = hashes.Hash(frame.left_path), right = hashes.Hash(frame.right_path);
    constexpr int kDigits = 12;  // of ten thousand frames one in ten million is taken for another
    if (left != right) content.images[i] = HashText(left + right).substr(0, kDigits);
    std::string text = fmt::format("{} {} {}", frame.stamp_ns, left, right);
    // How bright a frame's values are is told by the others.
    if (frame.sample_bits != StereoFrame().sample_bits) {
      text += fmt::format(" {} bits", frame.sample_bits);
    }
    content.frames[i] = HashText(text);
  });
  for (const LoneImage& image : dataset.lone_images) {
    content.lone += fmt::format("{} {} {}\n", image.stamp_ns, static_cast<int>(image.eye),
                                hashes.Hash(image.path));
  }
  std::string inclinometer;
  for (const InclinometerSample& sample : dataset.inclinometer) {
    const Eigen::Vector3d& up = sample.acceleration_in_imu;
    inclinometer += fmt::format("{} {} {} {}\n", sample.stamp_ns, up.x(), up.y(), up.z());
  }
  content.inclinometer = HashText(inclinometer);
  content.sensors = HashSensors(dataset);
  return content;
}

}  // namespace rigmap
