#include "dataset/internal/stereo_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <iterator>
#include <set>
#include <sstream>
#include <string>

#include "core/error.h"
#include "core/file.h"
#include "core/stamp_steps.h"
#include "dataset/internal/image_file.h"
#include "imaging/image.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

std::string Trimmed(const std::string& line) {
  const auto begin = line.find_first_not_of(" \t\r");
  if (begin == std::string::npos) return "";
  return line.substr(begin, line.find_last_not_of(" \t\r") + 1 - begin);
}

StampNs ParseTime(const std::string& text, const std::string& where) {
  try {
    return ParseSeconds(text);
  } catch (const DataError& error) {
    throw DataError(fmt::format("{}: {}", where, error.what()));
  }
}

std::vector<StampNs> ReadTimes(const fs::path& path) {
  std::istringstream lines(ReadTextFile(path));
  std::vector<StampNs> times;
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    const std::string text = Trimmed(line);
    if (text.empty() || text.front() == '#') continue;
    const auto where = fmt::format("{}:{}", path.string(), number);
    const StampNs stamp_ns = ParseTime(text, where);
    if (!times.empty() && stamp_ns <= times.back()) {
      throw DataError(fmt::format("{}: expected a time after {}, found {}", where,
                                  FormatSeconds(times.back()), text));
    }
    times.push_back(stamp_ns);
  }
  return times;
}

// Sequences have pairs a fraction of a second to a few seconds apart.
void RemarkOnTimes(const std::vector<StampNs>& times, const fs::path& path, DatasetHealth& health) {
  constexpr double kShortest_s = 1e-3, kLongest_s = 100.0;
  const double usual_s = 1e-9 * static_cast<double>(StepsOf(times).usual_ns);
  if (times.size() < 2 || (usual_s >= kShortest_s && usual_s <= kLongest_s)) return;
  health.remarks.push_back(fmt::format("{}: pairs are {:.3g} s apart: are the times in seconds?",
                                       path.string(), usual_s));
}

void NoteUnreadable(const std::vector<fs::path>& images, DatasetHealth& health) {
  for (const auto& path : images) {
    if (!IsWholeImage(path)) health.unreadable_images.push_back(path.string());
  }
}

std::string DigitsOf(const fs::path& path) {
  std::string digits;
  for (const unsigned char letter : path.stem().string()) {
    if (std::isdigit(letter)) digits += static_cast<char>(letter);
  }
  return digits;
}

void RemarkOnNames(const std::vector<StereoFrame>& frames, DatasetHealth& health) {
  std::size_t count = 0;
  const StereoFrame* first = nullptr;
  for (const auto& frame : frames) {
    if (DigitsOf(frame.left_path) == DigitsOf(frame.right_path)) continue;
    if (count++ == 0) first = &frame;
  }
  if (!first) return;
  health.remarks.push_back(
      fmt::format("{} of {} pairs, paired in the order of their names, have different numbers in "
                  "them, the first {} and {}",
                  count, frames.size(), first->left_path, first->right_path));
}

// A name cut into its numbers and what stands around them: one more text than numbers.
struct NumberedName {
  std::vector<std::string> texts, numbers;
};

NumberedName NumbersIn(const fs::path& path) {
  NumberedName name{{""}, {}};
  bool in_number = false;
  for (const char letter : path.stem().string()) {
    const bool is_digit = std::isdigit(static_cast<unsigned char>(letter)) != 0;
    if (is_digit && !in_number) name.numbers.emplace_back();
    if (!is_digit && in_number) name.texts.emplace_back();
    (is_digit ? name.numbers : name.texts).back() += letter;
    in_number = is_digit;
  }
  if (in_number) name.texts.emplace_back();
  return name;
}

// Of names that differ in their numbers alone and come in this order when they are sorted as text.
bool AreInOrder(const NumberedName& earlier, const NumberedName& later) {
  if (earlier.texts != later.texts) return true;
  for (std::size_t i = 0; i < later.numbers.size(); ++i) {
    const std::string &before = earlier.numbers[i], &behind = later.numbers[i];
    if (before == behind) continue;
    if (i > 0 && later.texts[i] == ".") return true;  // decimals, which text sorts as they are
    // Of numbers without leading zeros the one with fewer digits is smaller.
    return behind.size() >= before.size() || behind.front() == '0';
  }
  return true;
}

// Times are laid on images in the order of their names: 10 before 2 would mix them up.
void RequireOrderOfNumbers(const std::vector<fs::path>& images) {
  for (std::size_t i = 1; i < images.size(); ++i) {
    if (AreInOrder(NumbersIn(images[i - 1]), NumbersIn(images[i]))) continue;
    throw DataError(fmt::format(
        "{}: expected names that come in the order of their numbers when they are sorted as text, "
        "found it behind {}; pad the numbers with zeros",
        images[i].string(), images[i - 1].filename().string()));
  }
}

// "; FILE has no partner of its name", if missing partners alone make the numbers differ.
std::string FirstAlone(const std::vector<fs::path>& left, const std::vector<fs::path>& right) {
  const auto& more = left.size() > right.size() ? left : right;
  const auto& fewer = left.size() > right.size() ? right : left;
  std::set<fs::path> names;
  for (const fs::path& path : fewer) names.insert(path.filename());
  std::vector<fs::path> alone;
  std::ranges::copy_if(more, std::back_inserter(alone),
                       [&](const fs::path& path) { return !names.contains(path.filename()); });
  if (alone.size() != more.size() - fewer.size() || alone.empty()) return "";
  return fmt::format("; {} has no partner of its name", alone.front().string());
}

}  // namespace

bool IsStereoFolder(const fs::path& folder) {
  std::error_code ignored;
  return fs::is_directory(folder / "left", ignored) ||
         fs::is_directory(folder / "right", ignored) || fs::exists(folder / "times.txt", ignored);
}

Dataset ReadStereoFolder(const fs::path& folder) {
  const auto left = ListImages(folder / "left");
  const auto right = ListImages(folder / "right");
  if (left.empty() || left.size() != right.size()) {
    throw DataError(
        fmt::format("{}: expected as many images in left/ as in right/, at least one (png, jpg, "
                    "pgm, ppm, tif), "
                    "found {} and {}{}",
                    folder.string(), left.size(), right.size(), FirstAlone(left, right)));
  }
  RequireOrderOfNumbers(left);
  RequireOrderOfNumbers(right);
  const fs::path times_path = folder / "times.txt";
  const auto times = ReadTimes(times_path);
  if (times.size() != left.size()) {
    throw DataError(fmt::format("{}: expected {} times, one per pair, found {}",
                                times_path.string(), left.size(), times.size()));
  }
  Dataset dataset;
  dataset.format = DatasetFormat::kStereoFolder;
  for (std::size_t i = 0; i < left.size(); ++i) {
    dataset.frames.push_back({times[i], left[i].string(), right[i].string()});
  }
  dataset.health.images_read = static_cast<int>(left.size() + right.size());
  NoteUnreadable(left, dataset.health);
  NoteUnreadable(right, dataset.health);
  RemarkOnNames(dataset.frames, dataset.health);
  RemarkOnTimes(times, times_path, dataset.health);
  for (const char* name : {"groundtruth_tum.txt", "groundtruth_xy.txt"}) {
    const fs::path truth = folder / name;
    std::error_code ignored;
    if (dataset.truth_path.empty() && fs::is_regular_file(truth, ignored)) {
      dataset.truth_path = truth.string();
    }
  }
  return dataset;
}

}  // namespace rigmap
