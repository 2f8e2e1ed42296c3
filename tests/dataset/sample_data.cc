#include "tests/dataset/sample_data.h"

#include <cstdlib>
#include <functional>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

namespace rigmap {

std::string SampleRigText() {
  return "left:\n"
         "  model: OPENCV\n"
         "  width: 32\n"
         "  height: 24\n"
         "  fx: 30.5\n"
         "  fy: 30.25\n"
         "  cx: 15.5\n"
         "  cy: 11.75\n"
         "  distortion: [-0.1, 0.02, 0.001, -0.002]\n"
         "right:\n"
         "  model: PINHOLE\n"
         "  width: 32\n"
         "  height: 24\n"
         "  fx: 31\n"
         "  fy: 31\n"
         "  cx: 16\n"
         "  cy: 12\n"
         "right_from_left:\n"
         "  R: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n"
         "  t: [-0.12, 0, 0]\n";
}

std::string Replaced(const std::string& text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  if (at == std::string::npos || text.find(from, at + 1) != std::string::npos) {
    throw std::invalid_argument("not exactly once: " + from);
  }
  return std::string(text).replace(at, from.size(), to);
}

// Another one for each eye and name: only a camera that hangs takes the same image twice.
static cv::RNG RandomFor(const std::filesystem::path& path) {
  const auto name = path.parent_path().filename() / path.filename();
  return cv::RNG(std::hash<std::string>()(name.string()));
}

void WriteImage(const std::filesystem::path& path, int width, int height) {
  std::filesystem::create_directories(path.parent_path());
  cv::Mat image(height, width, CV_8UC1);
  cv::RNG random = RandomFor(path);
  random.fill(image, cv::RNG::UNIFORM, 0, 256);
  if (!cv::imwrite(path.string(), image)) throw std::runtime_error("cannot write " + path.string());
}

void WriteWideImage(const std::filesystem::path& path, int largest) {
  cv::Mat image(kSampleHeight, kSampleWidth, CV_16UC1);
  cv::RNG random = RandomFor(path);
  random.fill(image, cv::RNG::UNIFORM, 0, largest);
  image.at<std::uint16_t>(1, 2) = static_cast<std::uint16_t>(largest);
  if (!cv::imwrite(path.string(), image)) throw std::runtime_error("cannot write " + path.string());
}

void CutEnd(const std::filesystem::path& path, std::uintmax_t bytes) {
  std::filesystem::resize_file(path, std::filesystem::file_size(path) - bytes);
}

std::optional<std::filesystem::path> SharedData() {
  const char* folder = std::getenv("RIGMAP_DATA");
  return folder ? std::optional<std::filesystem::path>(folder) : std::nullopt;
}

}  // namespace rigmap
