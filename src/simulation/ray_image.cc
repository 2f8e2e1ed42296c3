#include "simulation/internal/ray_image.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace rigmap {
namespace {

// Weights of the rows of rays before and behind, from the middle of a row of pixels outwards.
constexpr std::array<float, 3> kSpot{0.3527f, 0.1298f, 0.0175f};

}  // namespace

RayImage::RayImage(const cv::Size& size)
    : size_(size), samples_(static_cast<std::size_t>(size.width) * kRaysPerRow * size.height) {}

std::span<RaySample> RayImage::Row(int ray_row) {
  return std::span(samples_).subspan(IndexOf(0, ray_row), size_.width);
}

Eigen::Vector3f RayImage::ThroughLens(int column, int row) const {
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (int i = 0; i < std::ssize(kSpot); ++i) {
    for (const int ray_row : {kRaysPerRow * row - i, kRaysPerRow * row + 1 + i}) {
      const int inside = std::clamp(ray_row, 0, RayRows() - 1);
      sum += kSpot[i] * samples_[IndexOf(column, inside)].colour;
    }
  }
  return sum;
}

bool RayImage::IsEdge(std::size_t at, std::size_t step) const {
  constexpr float kBend = 0.02f;
  const RaySample &here = samples_[at], &before = samples_[at - step], &after = samples_[at + step];
  return here.thing != before.thing || here.thing != after.thing ||
         std::abs(before.nearness + after.nearness - 2.0f * here.nearness) > kBend * here.nearness;
}

bool RayImage::IsAtEdge(int column, int row) const {
  if (row == 0 || column == 0 || row == size_.height - 1 || column == size_.width - 1) return false;
  const std::size_t above = IndexOf(column, kRaysPerRow * row), below = above + size_.width;
  const std::size_t step = IndexOf(0, kRaysPerRow);  // to the next row of pixels
  return IsEdge(above, 1) || IsEdge(above, step) || IsEdge(below, 1) || IsEdge(below, step);
}

}  // namespace rigmap
