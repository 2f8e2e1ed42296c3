#include "dataset/dataset_content.h"

#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>

#include "core/artefact.h"
#include "dataset/rig_file.h"

namespace rigmap {

std::string DatasetContent::Key() const {
  return HashText(fmt::format("{}\n{}\n{}", rig, FramesKey(), inclinometer));
}

std::string DatasetContent::FramesKey() const {
  return HashText(fmt::format("{}", fmt::join(frames, "\n")));
}

std::string DescribeRig(const StereoRig& rig) {
  StereoRig values = rig;
  values.left.mask_path.clear();
  values.right.mask_path.clear();
  return WriteRigFile(values);
}

DatasetContent HashContent(const Dataset& dataset, FileHashes& hashes) {
  DatasetContent content;
  std::string rig = DescribeRig(dataset.rig);
  for (const Eye eye : kEyes) {
    const std::string& mask_path = dataset.rig.Of(eye).mask_path;
    rig += mask_path.empty() ? "no mask\n" : hashes.Hash(mask_path) + "\n";
  }
  content.rig = HashText(rig);
  content.frames.resize(dataset.frames.size());
  tbb::parallel_for(std::size_t{0}, dataset.frames.size(), [&](std::size_t i) {
    const StereoFrame& frame = dataset.frames[i];
    std::string text = fmt::format("{} {} {}", frame.stamp_ns, hashes.Hash(frame.left_path),
                                   hashes.Hash(frame.right_path));
    // How bright a frame's values are is told by the others.
    if (frame.sample_bits != StereoFrame().sample_bits) {
      text += fmt::format(" {} bits", frame.sample_bits);
    }
    content.frames[i] = HashText(text);
  });
  std::string inclinometer;
  for (const InclinometerSample& sample : dataset.inclinometer) {
    const Eigen::Vector3d& up = sample.acceleration_in_imu;
    inclinometer += fmt::format("{} {} {} {}\n", sample.stamp_ns, up.x(), up.y(), up.z());
  }
  content.inclinometer = HashText(inclinometer);
  return content;
}

}  // namespace rigmap
