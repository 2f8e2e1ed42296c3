// Images as text that a page holds.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "core/stamp.h"

namespace rigmap {

// A JPEG as a data URL, at most `side_px` wide and high; empty where the file is missing or cannot
// be decoded.
std::string PictureUrl(const std::filesystem::path& path, int side_px, int quality);

// The same of many, on all threads of the job, with the width and the number chosen so that all
// of them together stay within about 5 MB: of more than kMostThumbnails every other, third, ... is
// left out, but those of `wanted`.
inline constexpr std::size_t kMostThumbnails = 600;
std::map<StampNs, std::string> Thumbnails(const std::map<StampNs, std::filesystem::path>& images,
                                          const std::set<StampNs>& wanted = {});

// Shares of 0 to 1, row by row, as a PNG of a pixel each from dark blue to yellow (viridis, which
// colour-blind people can read); negative ones are transparent.
std::string ColouredPictureUrl(const std::vector<double>& shares, int columns);

}  // namespace rigmap
