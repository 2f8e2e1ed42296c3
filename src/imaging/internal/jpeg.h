// JPEG files, decoded so that damage within one is known.
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <optional>

namespace rigmap {

// Pixels, 8 bit grey or BGR, as cv::imread has them (but for the orientation in EXIF data, which is
// ignored); empty where the decoder finds damage, of which cv::imread makes pixels and a line on
// stderr. A few bytes too many before the end marker, which some cameras write, are none. Nothing
// for what is no JPEG, or one of a colour space that is not grey, YCbCr or RGB.
std::optional<cv::Mat> DecodeJpeg(const std::filesystem::path& path, bool as_grey);

}  // namespace rigmap
