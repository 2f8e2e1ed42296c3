// What a stage keeps of single frames, each in a file of its own that is named after the frame and
// the key of what it was made from. Products of other options lie beside it, so that going back to
// them costs nothing.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace rigmap {

struct FrameFile {
  std::string name;  // relative to the output folder
  std::string key;

  std::filesystem::path In(const std::filesystem::path& root) const { return root / name; }

  template <class Archive>
  void serialize(Archive& archive) {
    archive(name, key);
  }
};

// stages/<stage>/<stamp>-<key>.bin
FrameFile FrameFileOf(const std::string& stage, std::int64_t stamp_ns, const std::string& key);

// True if all are there, with their key and to their end.
bool AreThere(const std::filesystem::path& root, const std::vector<FrameFile>& files);

// Removes what is kept of the same frames beside `in_use`, but for the file of each that was in use
// last. Call it with every product, so that it knows which was.
void ForgetOlderFrames(const std::filesystem::path& root, const std::vector<FrameFile>& in_use);

}  // namespace rigmap
