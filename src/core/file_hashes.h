// Hashes of files' contents that are remembered, so that a file is read again only if its size, its
// time or its inode has changed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>

namespace rigmap {

// Files are remembered by their own and their folder's name, so that a data set that was moved need
// not be read again. Their inodes tell two data sets apart whose images have equal names, sizes and
// times, as unpacked raw ones may have. Hash may be called from several threads.
class FileHashes {
 public:
  FileHashes() = default;
  // With what an earlier Save left there; a file that is missing or damaged is passed over.
  explicit FileHashes(const std::filesystem::path& remembered);

  // HashFile of its bytes. Throws DataError when it cannot be read.
  std::string Hash(const std::filesystem::path& path);
  // What was asked for since construction; the rest is forgotten.
  void Save(const std::filesystem::path& path) const;

 private:
  struct Entry {
    std::uintmax_t bytes = 0;
    std::int64_t modified_ns = 0;
    std::uint64_t inode = 0;
    std::string hash;

    template <class Archive>
    void serialize(Archive& archive) {
      archive(bytes, modified_ns, inode, hash);
    }
    bool IsSameFile(const Entry& other) const {
      return bytes == other.bytes && modified_ns == other.modified_ns && inode == other.inode;
    }
  };
  mutable std::mutex mutex_;
  std::map<std::string, Entry> known_, asked_;
};

}  // namespace rigmap
