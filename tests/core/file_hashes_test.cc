#include "core/file_hashes.h"

#include <gmock/gmock.h>

#include <chrono>
#include <fstream>

#include "core/artefact.h"
#include "core/error.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_file.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

class FileHashesTest : public testing::Test {
 protected:
  FileHashesTest() { WriteTestFile(file_, "first"); }
  // Other bytes, but inode, size and time as they were.
  void SwapContent() {
    const auto time = fs::last_write_time(file_);
    std::ofstream(file_) << "other";
    fs::last_write_time(file_, time);
  }

  TemporaryFolder folder_;
  fs::path file_ = folder_.Path() / "image.png", memory_ = folder_.Path() / "hashes.bin";
};

TEST_F(FileHashesTest, AreThoseOfTheContent) {
  FileHashes hashes;
  EXPECT_EQ(hashes.Hash(file_), HashFile(file_));
  WriteTestFile(folder_.Path() / "copy.png", "first");
  EXPECT_EQ(hashes.Hash(folder_.Path() / "copy.png"), hashes.Hash(file_));
}

TEST_F(FileHashesTest, SaveReadingAgainWhatKeptItsSizeAndTime) {
  FileHashes first;
  const std::string hash = first.Hash(file_);
  first.Save(memory_);
  SwapContent();
  EXPECT_EQ(FileHashes(memory_).Hash(file_), hash);
  // Without memory, or with another time, it is read.
  EXPECT_EQ(FileHashes().Hash(file_), HashFile(file_));
  fs::last_write_time(file_, fs::last_write_time(file_) + std::chrono::seconds(1));
  EXPECT_EQ(FileHashes(memory_).Hash(file_), HashFile(file_));
}

TEST_F(FileHashesTest, KnowAFileThatMovedWithItsFolder) {
  fs::create_directories(folder_.Path() / "a" / "left");
  fs::rename(file_, folder_.Path() / "a" / "left" / "1.png");
  FileHashes first;
  const std::string hash = first.Hash(folder_.Path() / "a" / "left" / "1.png");
  first.Save(memory_);
  fs::rename(folder_.Path() / "a", folder_.Path() / "b");
  file_ = folder_.Path() / "b" / "left" / "1.png";
  SwapContent();
  EXPECT_EQ(FileHashes(memory_).Hash(file_), hash);
}

// As raw images of one size are, once they were unpacked with the times of the archive.
TEST_F(FileHashesTest, TellDataSetsApartWhoseImagesHaveEqualNamesSizesAndTimes) {
  const fs::path one = folder_.Path() / "one" / "left" / "1.pgm";
  const fs::path two = folder_.Path() / "two" / "left" / "1.pgm";
  for (const fs::path& path : {one, two}) {
    fs::create_directories(path.parent_path());
    WriteTestFile(path, path == one ? "first" : "other");
    fs::last_write_time(path, fs::last_write_time(file_));
  }
  FileHashes first;
  first.Hash(one);
  first.Save(memory_);
  FileHashes second(memory_);
  EXPECT_EQ(second.Hash(two), HashFile(two));
  EXPECT_EQ(second.Hash(one), HashFile(one));
}

TEST_F(FileHashesTest, ForgetWhatWasNotAskedForAgain) {
  FileHashes first;
  first.Hash(file_);
  first.Save(memory_);
  FileHashes(memory_).Save(memory_);
  SwapContent();
  EXPECT_EQ(FileHashes(memory_).Hash(file_), HashFile(file_));
}

TEST_F(FileHashesTest, OfAFileThatIsGoneAreAnError) {
  fs::remove(file_);
  EXPECT_THROW(FileHashes().Hash(file_), DataError);
}

TEST_F(FileHashesTest, PassOverADamagedMemory) {
  WriteTestFile(memory_, "noise");
  EXPECT_EQ(FileHashes(memory_).Hash(file_), HashFile(file_));
}

}  // namespace
}  // namespace rigmap
