// Small data sets for tests: tiny images and a rig that fits them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace rigmap {

constexpr int kSampleWidth = 32;
constexpr int kSampleHeight = 24;

// A rig file for images of kSampleWidth x kSampleHeight; every line ends in "\n".
std::string SampleRigText();

// `text` with its only occurrence of `from` replaced by `to`.
std::string Replaced(const std::string& text, const std::string& from, const std::string& to);

// A whole image of noise in the format that the extension tells, another one for each name; creates
// the parent folder.
void WriteImage(const std::filesystem::path& path, int width = kSampleWidth,
                int height = kSampleHeight);

// The same with values from 0 to `largest` in 16 bit each.
void WriteWideImage(const std::filesystem::path& path, int largest);

// Cuts the last `bytes` off a file.
void CutEnd(const std::filesystem::path& path, std::uintmax_t bytes);

// The environment variable RIGMAP_DATA; nothing where it is not set.
std::optional<std::filesystem::path> SharedData();

}  // namespace rigmap
