// What an image file says of itself before its pixels.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace rigmap {

struct ImageHeader {
  std::int64_t width = 0;  // pixels, positive
  std::int64_t height = 0;
  std::int64_t sample_bits = 8;  // of one value in the file
  bool is_whole = false;         // the file reaches to where the image must end
  bool has_fractions = false;    // floating-point numbers
};

// Of a PNG, JPEG, PGM, PPM (PBM) or TIFF file, told by its first bytes and whatever its name; of a
// TIFF of several images the first. Nothing for any other file, for BigTIFF and where the header
// itself is damaged. Reads some hundred bytes and allocates no more, whatever the header claims.
//
// A PNG or JPEG is whole if its end marker stands in the last kilobyte (cameras pad behind it), a
// PNM file if it is long enough for its pixels, a TIFF if its strips or tiles lie within the file.
// Damage in between is not seen before the pixels are decoded.
std::optional<ImageHeader> ReadImageHeader(const std::filesystem::path& path);

}  // namespace rigmap
