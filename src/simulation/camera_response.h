// From radiance to the image that a camera stores: glare, bloom, vignetting, exposure, noise, eight
// bits. Geometry stays as it is.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

namespace rigmap {

struct CameraResponse {
  double exposure = 0.86;     // full scale per radiance, at the image's centre
  double blur_px = 0.3;       // one standard deviation of the colour filter's blur
  double vignetting = 0.22;   // share of light that the corners lose
  double bloom = 0.25;        // share of what is above full scale that spreads around it
  double smear = 0.0002;      // and that each saturated pixel adds to its column, as a CCD does
  double read_noise = 0.8;    // one standard deviation, grey levels, in the dark
  double shot_noise = 0.012;  // variance that each grey level adds
};

// What is special about one image.
struct Shot {
  double exposure_gain = 1.0;
  double glare_area = 0.0;  // share of the image that stray sunlight saturates
  // Where the glare sits: equal seeds, equal pattern in the image (the sun is equally far from both
  // eyes), whatever is behind it.
  std::uint32_t glare_seed = 0;
  double glare_column_px = 0.0;  // by which the pattern is moved aside
  std::uint32_t noise_seed = 0;
};

// `radiance`: red, green, blue, CV_32FC3, as ViewRenderer makes it; its pixels are overwritten.
// Returns blue, green, red, CV_8UC3, as OpenCV stores images.
cv::Mat TakePicture(cv::Mat radiance, const CameraResponse& response, const Shot& shot);

// Share of pixels at full scale in all three colours.
double SaturatedShare(const cv::Mat& picture);

}  // namespace rigmap
