#include "dataset/internal/image_checks.h"

#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <utility>
#include <vector>

#include "core/error.h"
#include "imaging/image.h"

namespace rigmap {
namespace {

void CheckSize(const std::string& path, const Camera& camera, const std::string& rig_source) {
  const cv::Size found = ReadSize(path);
  if (found != cv::Size(camera.width, camera.height)) {
    throw DataError(fmt::format("{}: expected {} x {} pixels as in {}, found {} x {}", path,
                                camera.width, camera.height, rig_source, found.width,
                                found.height));
  }
}

void CheckMask(const RigEye& eye, const std::string& rig_source) {
  if (eye.mask_path.empty()) return;
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(eye.mask_path, ignored)) {
    throw DataError(
        fmt::format("{}: expected a mask image, found no file {}", rig_source, eye.mask_path));
  }
  CheckSize(eye.mask_path, eye.camera, rig_source);
}

// False if it cannot be read.
bool CheckImage(const std::string& path, Eye eye, const StereoRig& rig) {
  try {
    CheckSize(path, rig.Of(eye).camera, rig.source);
    return true;
  } catch (const UnreadableImage&) {
    return false;
  }
}

// False also where a file cannot be read, or is empty.
bool HaveEqualBytes(const std::string& a, const std::string& b) {
  std::error_code no_a, no_b;
  const auto size_a = std::filesystem::file_size(a, no_a),
             size_b = std::filesystem::file_size(b, no_b);
  if (no_a || no_b || size_a != size_b || size_a == 0) return false;
  std::ifstream of_a(a, std::ios::binary), of_b(b, std::ios::binary);
  using Bytes = std::istreambuf_iterator<char>;
  return of_a && of_b && std::equal(Bytes(of_a), Bytes(), Bytes(of_b), Bytes());
}

// Of a pair's images, which repeat those before.
struct Repeat {
  bool left = false, right = false;

  bool IsAny() const { return left || right; }
  bool IsOnly(Eye eye) const { return left != right && (eye == Eye::kLeft ? left : right); }
};

// Files that are no images may be alike.
Repeat RepeatOf(const StereoFrame& before, const StereoFrame& frame,
                const std::set<std::string>& unreadable) {
  const auto repeats = [&](Eye eye) {
    return HaveEqualBytes(before.PathOf(eye), frame.PathOf(eye)) &&
           !unreadable.contains(frame.PathOf(eye));
  };
  const Repeat repeat{repeats(Eye::kLeft), repeats(Eye::kRight)};
  const bool is_black = repeat.IsAny() && HaveEqualBytes(frame.left_path, frame.right_path);
  return is_black ? Repeat() : repeat;
}

}  // namespace

void LeaveOutRepeats(Dataset& dataset) {
  std::vector<StereoFrame>& frames = dataset.frames;
  const std::set<std::string> unreadable(dataset.health.unreadable_images.begin(),
                                         dataset.health.unreadable_images.end());
  std::vector<Repeat> repeats(frames.size());
  tbb::parallel_for(std::size_t{1}, std::max<std::size_t>(1, frames.size()), [&](std::size_t i) {
    repeats[i] = RepeatOf(frames[i - 1], frames[i], unreadable);
  });
  const auto first =
      static_cast<std::size_t>(std::ranges::find_if(repeats, &Repeat::IsAny) - repeats.begin());
  if (first == frames.size()) return;
  for (const Eye eye : kEyes) {
    const auto stuck = static_cast<std::size_t>(
        std::ranges::count_if(repeats, [&](const Repeat& repeat) { return repeat.IsOnly(eye); }));
    if (2 * stuck <= frames.size()) continue;
    throw DataError(
        fmt::format("{}: expected images of a camera that goes on, found {} of {} that "
                    "repeat the one before byte for byte while the other eye's do not",
                    frames[first].PathOf(eye), stuck, frames.size()));
  }
  dataset.health.remarks.push_back(
      fmt::format("{}: of {} pairs, of which this is the first, an image repeats the one before "
                  "byte for byte, as no camera's do but one that hangs: they are left out",
                  frames[first].left_path, std::ranges::count_if(repeats, &Repeat::IsAny)));
  std::vector<StereoFrame> kept;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (!repeats[i].IsAny()) kept.push_back(std::move(frames[i]));
  }
  frames = std::move(kept);
}

void CheckSizes(const Dataset& dataset) {
  const StereoRig& rig = dataset.rig;
  for (const Eye eye : kEyes) CheckMask(rig.Of(eye), rig.source);
  for (const LoneImage& image : dataset.lone_images) CheckImage(image.path, image.eye, rig);
  const auto& frames = dataset.frames;
  const auto readable = std::count_if(frames.begin(), frames.end(), [&](const StereoFrame& frame) {
    const bool is_left_readable = CheckImage(frame.left_path, Eye::kLeft, rig);
    return CheckImage(frame.right_path, Eye::kRight, rig) && is_left_readable;
  });
  if (readable > 0) return;
  throw DataError(
      fmt::format("{}: expected images, found none that can be read in both eyes of any of {} "
                  "pairs, of which this is the first",
                  frames.front().left_path, frames.size()));
}

void DecideSampleBits(const StereoRig& rig, std::vector<StereoFrame>& frames) {
  std::atomic<int> most = 0;  // 0: no file of 16 bit
  tbb::parallel_for(std::size_t{0}, frames.size(), [&](std::size_t i) {
    for (const Eye eye : kEyes) {
      if (most == 16) return;
      const int bits = SampleBitsNeeded(frames[i].PathOf(eye), rig.Of(eye).camera).value_or(0);
      for (int before = most; bits > before && !most.compare_exchange_weak(before, bits);) {
      }
    }
  });
  if (most == 0) return;
  for (StereoFrame& frame : frames) frame.sample_bits = most;
}

}  // namespace rigmap
