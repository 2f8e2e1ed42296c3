#include "raster/internal/picture_frame.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace rigmap {
namespace {

const cv::Scalar kInk{40, 40, 40};
const cv::Scalar kWhite{255, 255, 255};
const cv::Scalar kWarningColour{20, 20, 200};  // red
constexpr double kTextScale = 0.6;             // of OpenCV's plain font: 13 px high
constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr int kShift = 4;  // binary digits of a pixel's fraction in OpenCV's points

cv::Point Fixed(const Eigen::Vector2d& x_px) {
  return {static_cast<int>(std::lround(std::ldexp(x_px.x(), kShift))),
          static_cast<int>(std::lround(std::ldexp(x_px.y(), kShift)))};
}

void DrawText(cv::Mat3b& picture, const std::string& text, const cv::Point& at, bool outlined) {
  if (outlined) cv::putText(picture, text, at, kFont, kTextScale, kWhite, 4, cv::LINE_AA);
  cv::putText(picture, text, at, kFont, kTextScale, kInk, 1, cv::LINE_AA);
}

void DrawMark(cv::Mat3b& picture, const Eigen::Vector2d& at_px, const cv::Scalar& colour,
              const std::string& word) {
  const cv::Point centre(cvRound(at_px.x()), cvRound(at_px.y()));
  cv::circle(picture, centre, 9, kWhite, cv::FILLED, cv::LINE_AA);
  cv::circle(picture, centre, 7, colour, cv::FILLED, cv::LINE_AA);
  const cv::Size size = cv::getTextSize(word, kFont, kTextScale, 1, nullptr);
  const int x = std::clamp(centre.x - size.width / 2, 4, picture.cols - 4 - size.width);
  DrawText(picture, word, {x, centre.y - 14}, true);
}

}  // namespace

double ScaleBarLength(double max_length_m) {
  const double power = std::pow(10.0, std::floor(std::log10(max_length_m)));
  // A hair's breadth for what log10 and pow round off.
  const double mantissa = max_length_m / power * (1.0 + 1e-12);
  return power * (mantissa >= 10.0  ? 10.0
                  : mantissa >= 5.0 ? 5.0
                  : mantissa >= 2.0 ? 2.0
                  : mantissa >= 1.0 ? 1.0
                                    : 0.5);
}

std::string ScaleBarLabel(double length_m) { return fmt::format("{:.6g} m", length_m); }

Canvas EmptyCanvas(const cv::Size& view) {
  const int width = std::max(view.width + 2 * kMarginPx, kMinPictureWidth);
  const int height = view.height + 2 * kMarginPx + kFooterPx;
  return {cv::Mat(height, width, CV_8UC3, kBackgroundColour),
          cv::Rect((width - view.width) / 2, kMarginPx, view.width, view.height)};
}

void DrawPlumbLine(cv::Mat3b& picture, const Eigen::Vector2d& camera_px,
                   const Eigen::Vector2d& foot_px) {
  cv::line(picture, Fixed(camera_px), Fixed(foot_px), kPathColour, 1, cv::LINE_AA, kShift);
  constexpr int kDot = 3 << kShift;
  cv::circle(picture, Fixed(foot_px), kDot, kPathColour, cv::FILLED, cv::LINE_AA, kShift);
}

void DrawPath(cv::Mat3b& picture, const std::vector<Eigen::Vector2d>& path_px) {
  if (path_px.empty()) return;
  std::vector<cv::Point> line;
  for (const Eigen::Vector2d& x_px : path_px) line.push_back(Fixed(x_px));
  cv::polylines(picture, line, false, kWhite, 6, cv::LINE_AA, kShift);
  cv::polylines(picture, line, false, kPathColour, 3, cv::LINE_AA, kShift);
  constexpr double kApartPx = 60.0;  // nearer the two words would cover each other
  const bool apart = (path_px.back() - path_px.front()).norm() > kApartPx;
  if (path_px.size() > 1) DrawMark(picture, path_px.back(), kPathColour, apart ? "end" : "");
  DrawMark(picture, path_px.front(), kStartColour,
           apart || path_px.size() == 1 ? "start" : "start, end");
}

void DrawWarning(cv::Mat3b& picture, const std::string& words) {
  constexpr int kFramePx = 6;
  std::string text = words;
  const auto colon = std::min(text.find(':'), text.size());
  std::transform(
      text.begin(), text.begin() + static_cast<std::ptrdiff_t>(colon), text.begin(),
      [](unsigned char character) { return static_cast<char>(std::toupper(character)); });
  cv::rectangle(picture, {0, 0}, {picture.cols - 1, picture.rows - 1}, kWarningColour,
                2 * kFramePx - 1);  // half of it falls outside
  cv::rectangle(picture, cv::Rect(0, 0, picture.cols, kMarginPx), kWarningColour, cv::FILLED);
  const cv::Size size = cv::getTextSize(text, kFont, 1.0, 2, nullptr);
  const double scale = std::min(0.8, (picture.cols - 2.0 * kMarginPx) / size.width);
  const int baseline = cvRound((kMarginPx + scale * size.height) / 2.0);
  cv::putText(picture, text, {kMarginPx, baseline}, kFont, scale, kWhite, 2, cv::LINE_AA);
}

double DrawFooter(Canvas& canvas, double px_per_m, const std::string& caption) {
  cv::Mat3b& picture = canvas.picture;
  const double length_m = ScaleBarLength((picture.cols - 2 * kMarginPx) / 4.0 / px_per_m);
  const int bar_px = cvRound(length_m * px_per_m);
  const int y = canvas.view.br().y + kMarginPx;
  int x = kMarginPx;
  cv::rectangle(picture, cv::Rect(x, y, bar_px, 8), kInk, cv::FILLED);
  cv::rectangle(picture, cv::Rect(x + bar_px / 2, y + 2, bar_px - bar_px / 2 - 2, 4), kWhite,
                cv::FILLED);
  x += bar_px + 12;
  DrawText(picture, ScaleBarLabel(length_m), {x, y + 11}, false);
  x += cv::getTextSize(ScaleBarLabel(length_m), kFont, kTextScale, 1, nullptr).width + 48;
  cv::line(picture, {x, y + 4}, {x + 40, y + 4}, kPathColour, 3, cv::LINE_AA);
  DrawText(picture, "path of the left camera", {x + 52, y + 11}, false);
  DrawText(picture, caption, {kMarginPx, y + 48}, false);
  return length_m;
}

}  // namespace rigmap
