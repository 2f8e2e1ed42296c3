// The folder that a part's results go to: its layout, its lock, and whose it is.
#pragma once

#include <filesystem>
#include <string>

namespace rigmap {

struct OutputLayout {
  std::filesystem::path root;

  std::filesystem::path Artefact(const std::string& stage) const {
    return root / "stages" / (stage + ".bin");
  }
  std::filesystem::path Features() const { return root / "stages" / "features"; }
  std::filesystem::path Depths() const { return root / "stages" / "dense"; }
  std::filesystem::path Scratch() const { return root / "stages" / "scratch"; }
  std::filesystem::path Log(const std::string& stage) const {
    return root / "logs" / (stage + ".log");
  }
  std::filesystem::path Colmap() const { return root / "colmap"; }
  std::filesystem::path Database() const { return Colmap() / "database.db"; }
  std::filesystem::path Images() const { return Colmap() / "images"; }
  std::filesystem::path Models() const { return Colmap() / "models"; }
  std::filesystem::path Sparse() const { return root / "sparse"; }
};

// Holds the folder for this process alone until destroyed (flock, not inherited by children).
class OutputLock {
 public:
  // Creates the folder. Throws DataError when it cannot be written or another process holds it.
  explicit OutputLock(const std::filesystem::path& root);
  ~OutputLock();
  OutputLock(const OutputLock&) = delete;
  OutputLock& operator=(const OutputLock&) = delete;

 private:
  int descriptor_ = -1;
};

// Makes sure that the folder is new or holds results of the same data, which `identity` names (a
// line). Otherwise DataError, or with `force` everything in it but the lock is removed first.
void ClaimOutput(const OutputLayout& layout, const std::string& identity, bool force);

}  // namespace rigmap
