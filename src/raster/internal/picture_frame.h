// What is drawn into and around a picture of a part: scale bar, path, words.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace rigmap {

constexpr int kMarginPx = 32;          // around the view
constexpr int kFooterPx = 84;          // below it, for scale bar and words
constexpr int kMinPictureWidth = 960;  // px; narrower the words do not fit

// Colours as OpenCV has them: blue, green, red.
inline const cv::Scalar kPathColour{120, 0, 230};          // magenta: neither sand, rock nor sky
inline const cv::Scalar kStartColour{60, 170, 0};          // green
inline const cv::Scalar kBackgroundColour{244, 244, 244};  // light grey

// The longest length of 1, 2 or 5 times a power of ten that is at most `max_length_m` > 0.
double ScaleBarLength(double max_length_m);

// "2 m", "0.5 m".
std::string ScaleBarLabel(double length_m);

// An empty picture for a view of this size (px), which goes to the returned rectangle.
struct Canvas {
  cv::Mat3b picture;
  cv::Rect view;
};
Canvas EmptyCanvas(const cv::Size& view);

// The path through these points (px, in the picture), its start and end marked.
void DrawPath(cv::Mat3b& picture, const std::vector<Eigen::Vector2d>& path_px);

// A thin line from a place on the path to the ground below it, ending in a dot.
void DrawPlumbLine(cv::Mat3b& picture, const Eigen::Vector2d& camera_px,
                   const Eigen::Vector2d& foot_px);

// Below the view: a scale bar of at most a quarter of the picture's width, what the line is, and
// the caption. Returns the bar's length in metres.
double DrawFooter(Canvas& canvas, double px_per_m, const std::string& caption);

// A red band along the top, in the margin, with these words in capitals up to the first colon, and
// a red frame around the picture. The words are made as small as they must to fit.
void DrawWarning(cv::Mat3b& picture, const std::string& words);

}  // namespace rigmap
