#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "core/error.h"
#include "core/yaml.h"
#include "dataset/internal/rig_nodes.h"

namespace rigmap {
namespace {

void RefuseFisheye(const YamlNode& model) {
  constexpr std::array kFisheyeNames{"FISHEYE", "KANNALA", "EQUIDISTANT", "FOV", "OMNI", "MEI"};
  std::string name = model.AsString();
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::toupper(letter)); });
  for (const std::string_view fisheye : kFisheyeNames) {
    if (name.find(fisheye) != std::string::npos) {
      throw RigComplaint(
          model, fmt::format("expected model PINHOLE, OPENCV or FULL_OPENCV, found the fisheye "
                             "model '{}', which is not supported",
                             model.scalar));
    }
  }
}

constexpr std::size_t kOpenCvNumbers = 4, kFullOpenCvNumbers = 8;

void RefuseMisplacedDistortion(const YamlNode& eye) {
  for (const char* key : {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"}) {
    if (const YamlNode* node = eye.Find(key)) {
      throw RigComplaint(*node,
                         fmt::format("expected {} in distortion: [k1, k2, p1, p2], or [k1, k2, "
                                     "p1, p2, k3, 0, 0, 0] of model FULL_OPENCV, found it alone",
                                     key));
    }
  }
}

// k1, k2, p1, p2, k3: of the model FULL_OPENCV all eight numbers, or OpenCV's first five.
std::vector<double> ReadFullDistortion(const YamlNode& node) {
  auto numbers = node.AsDoubles(node.items.size() == 5 ? 5 : kFullOpenCvNumbers);
  numbers.resize(kFullOpenCvNumbers);
  if (std::any_of(numbers.begin() + 5, numbers.end(), [](double k) { return k != 0.0; })) {
    throw RigComplaint(node,
                       fmt::format("expected distortion: [k1, k2, p1, p2, k3, 0, 0, 0], found "
                                   "[{}]: k4, k5 and k6 are not supported",
                                   fmt::join(numbers, ", ")));
  }
  return numbers;
}

std::vector<double> ReadPlainDistortion(const YamlNode& node) {
  if (node.items.size() > kOpenCvNumbers) {
    throw RigComplaint(node,
                       fmt::format("expected distortion: [k1, k2, p1, p2], found {} numbers: k3 "
                                   "is of the model FULL_OPENCV",
                                   node.items.size()));
  }
  auto numbers = node.AsDoubles(kOpenCvNumbers);
  numbers.push_back(0.0);
  return numbers;
}

int ReadSize(const YamlNode& node) {
  const int size = node.AsInt();
  if (size <= 0) throw RigComplaint(node, fmt::format("expected a positive size, found {}", size));
  return size;
}

// Fisheyes have a fifth of the width, telescopes some tens; millimetres and shares of the width are
// hundreds of times off.
double ReadFocal(const YamlNode& node, int width) {
  constexpr double kShortest = 0.1, kLongest = 100.0;
  const double focal = node.AsDouble();
  if (!(focal > 0.0)) {
    throw RigComplaint(node, fmt::format("expected a positive focal length, found {}", focal));
  }
  if (focal < kShortest * width || focal > kLongest * width) {
    throw RigComplaint(node, fmt::format("expected a focal length in pixels, of {:g} to {:g} for "
                                         "images {} pixels wide, found {}",
                                         kShortest * width, kLongest * width, width, focal));
  }
  return focal;
}

// Pixels are as wide as they are high, or nearly so; of interlaced video one is twice the other.
void RequireAspect(const YamlNode& eye, const Camera& camera) {
  constexpr double kMostUnlike = 2.5;
  const double aspect = camera.fy / camera.fx;
  if (aspect > 1.0 / kMostUnlike && aspect < kMostUnlike) return;
  throw RigComplaint(
      eye.At("fy"), fmt::format("expected focal lengths alike, fy within {:g} times fx either way, "
                                "found fx = {:g} and fy = {:g}",
                                kMostUnlike, camera.fx, camera.fy));
}

// Half-way to its corners at least, an image must have rays; calibrations run wild beyond.
void RequireRays(const YamlNode& eye, const Camera& camera) {
  const Eigen::Vector2d middle(camera.cx, camera.cy);
  for (const double x : {0.0, camera.width - 1.0}) {
    for (const double y : {0.0, camera.height - 1.0}) {
      if (Undistort(camera, 0.5 * (middle + Eigen::Vector2d(x, y)))) continue;
      throw RigComplaint(
          eye.At("distortion"),
          fmt::format("expected a distortion that at least the middle of the image can be freed "
                      "from, found k1 = {:g}, k2 = {:g}, p1 = {:g}, p2 = {:g}, k3 = {:g}",
                      camera.k1, camera.k2, camera.p1, camera.p2, camera.k3));
    }
  }
}

void ReadDistortion(const YamlNode& eye, Camera& camera) {
  const YamlNode& model = eye.At("model");
  const bool pinhole = model.scalar == "PINHOLE", full = model.scalar == "FULL_OPENCV";
  if (!pinhole && !full && model.scalar != "OPENCV") {
    throw RigComplaint(
        model,
        fmt::format("expected model PINHOLE, OPENCV or FULL_OPENCV, found '{}'", model.scalar));
  }
  if (pinhole && !eye.Find("distortion")) return;
  const YamlNode& distortion = eye.At("distortion");
  const auto numbers = full ? ReadFullDistortion(distortion) : ReadPlainDistortion(distortion);
  camera.k1 = numbers[0];
  camera.k2 = numbers[1];
  camera.p1 = numbers[2];
  camera.p2 = numbers[3];
  camera.k3 = numbers[4];
  if (pinhole && !camera.IsPinhole()) {
    throw RigComplaint(distortion,
                       fmt::format("expected no distortion for model PINHOLE, found [{}]",
                                   fmt::join(distortion.AsDoubles(kOpenCvNumbers), ", ")));
  }
}

Camera ReadCamera(const YamlNode& eye) {
  Camera camera;
  ReadDistortion(eye, camera);
  camera.width = ReadSize(eye.At("width"));
  camera.height = ReadSize(eye.At("height"));
  camera.fx = ReadFocal(eye.At("fx"), camera.width);
  camera.fy = ReadFocal(eye.At("fy"), camera.width);
  RequireAspect(eye, camera);
  camera.cx = eye.At("cx").AsDouble();
  camera.cy = eye.At("cy").AsDouble();
  if (!camera.Contains({camera.cx, camera.cy})) {
    throw RigComplaint(
        eye.At("cx"),
        fmt::format("expected the principal point inside the image of {} x {} pixels, "
                    "found ({}, {})",
                    camera.width, camera.height, camera.cx, camera.cy));
  }
  if (!camera.IsPinhole()) RequireRays(eye, camera);
  return camera;
}

PixelRegion ReadRegion(const YamlNode& node, const Camera& camera) {
  const auto edges = node.AsDoubles(4);
  const auto inside = [](double value, int size) { return std::clamp(value, 0.0, size - 1.0); };
  const PixelRegion region{static_cast<int>(std::ceil(inside(edges[0], camera.width))),
                           static_cast<int>(std::ceil(inside(edges[1], camera.height))),
                           static_cast<int>(std::floor(inside(edges[2], camera.width))),
                           static_cast<int>(std::floor(inside(edges[3], camera.height)))};
  if (region.x0 >= region.x1 || region.y0 >= region.y1) {
    throw RigComplaint(node,
                       fmt::format("expected [x0, y0, x1, y1] with x0 < x1 and y0 < y1 inside "
                                   "the image of {} x {} pixels, found [{}]",
                                   camera.width, camera.height, fmt::join(edges, ", ")));
  }
  return region;
}

RigEye ReadEye(const YamlNode& node, const std::filesystem::path& folder) {
  RigEye eye;
  RefuseFisheye(node.At("model"));
  RefuseMisplacedDistortion(node);
  node.RequireKeys({"model", "width", "height", "fx", "fy", "cx", "cy", "distortion",
                    "calibrated_region", "mask"});
  eye.camera = ReadCamera(node);
  if (const YamlNode* region = node.Find("calibrated_region")) {
    eye.calibrated_region = ReadRegion(*region, eye.camera);
  }
  if (const YamlNode* mask = node.Find("mask")) {
    if (mask->AsString().empty()) throw RigComplaint(*mask, "expected a mask image, found ''");
    eye.mask_path =
        std::filesystem::absolute(folder / mask->AsString()).lexically_normal().string();
  }
  return eye;
}

}  // namespace

DataError RigComplaint(const YamlNode& node, const std::string& what) {
  return DataError(fmt::format("{}: {}", node.where, what));
}

StereoRig ReadRigNode(const YamlNode& root, const std::filesystem::path& path) {
  root.RequireKeys({"left", "right", "right_from_left", "baseline_m", "rectified",
                    "antenna_in_left", "imu_from_left", "wheels", "sigmas", "pool"});
  StereoRig rig;
  rig.source = path.string();
  rig.left = ReadEye(root.At("left"), path.parent_path());
  rig.right = ReadEye(root.At("right"), path.parent_path());
  rig.right_from_left = ReadRigid(root.At("right_from_left"));
  CheckBaseline(root, rig);
  CheckRectified(root, rig.right_from_left);
  if (const YamlNode* antenna = root.Find("antenna_in_left")) {
    rig.antenna_in_left = ReadLever(*antenna);
  }
  if (const YamlNode* imu = root.Find("imu_from_left")) {
    rig.imu_from_left = ReadRigid(*imu);
    ReadLever(imu->At("t"));
  }
  if (const YamlNode* wheels = root.Find("wheels")) rig.wheels = ReadWheelsNode(*wheels);
  if (const YamlNode* sigmas = root.Find("sigmas")) ReadSigmasNode(*sigmas, rig);
  return rig;
}

}  // namespace rigmap
