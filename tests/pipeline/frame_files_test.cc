#include "pipeline/frame_files.h"

#include <gtest/gtest.h>

#include "core/artefact.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

class FrameFiles : public testing::Test {
 protected:
  FrameFile Write(std::int64_t stamp_ns, const std::string& key) const {
    const FrameFile file = FrameFileOf("dense", stamp_ns, key);
    WriteArtefact(file.In(Root()), key, std::string("depth"));
    return file;
  }
  bool IsThere(const FrameFile& file) const { return std::filesystem::exists(file.In(Root())); }
  const std::filesystem::path& Root() const { return folder_.Path(); }

  TemporaryFolder folder_;
};

TEST_F(FrameFiles, AreNamedAfterStageFrameAndKey) {
  const FrameFile file = FrameFileOf("dense", 17, "abc");
  EXPECT_EQ(file.name, "stages/dense/17-abc.bin");
  EXPECT_EQ(file.In("/out"), "/out/stages/dense/17-abc.bin");
}

TEST_F(FrameFiles, AreThereOnlyIfAllAre) {
  const FrameFile one = Write(1, "a"), two = Write(2, "a");
  EXPECT_TRUE(AreThere(Root(), {one, two}));
  EXPECT_FALSE(AreThere(Root(), {one, FrameFileOf("dense", 2, "b")}));
  // One that was cut off, by a disk that ran full or a copy that was broken off.
  std::filesystem::resize_file(two.In(Root()), 50);
  EXPECT_FALSE(AreThere(Root(), {one, two}));
}

TEST_F(FrameFiles, OfTheLastOptionsInUseAreKeptBesideThoseOfNow) {
  const FrameFile other_frame = Write(2, "a");
  const FrameFile first = Write(1, "a");
  ForgetOlderFrames(Root(), {first});
  const FrameFile second = Write(1, "b");
  ForgetOlderFrames(Root(), {second});
  EXPECT_TRUE(IsThere(first));  // going back to it costs nothing
  const FrameFile third = Write(1, "c");
  ForgetOlderFrames(Root(), {third});
  EXPECT_FALSE(IsThere(first));
  EXPECT_TRUE(IsThere(second));
  EXPECT_TRUE(IsThere(third));
  EXPECT_TRUE(IsThere(other_frame));
}

}  // namespace
}  // namespace rigmap
