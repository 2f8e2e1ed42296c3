#include "dataset/image_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/dataset/sample_data.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

class ImageFormatTest : public testing::TestWithParam<const char*> {
 protected:
  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_.Path() / (std::string("image.") + GetParam());
};

TEST_P(ImageFormatTest, WholeImageIsWhole) {
  WriteImage(path_);
  EXPECT_TRUE(IsWholeImage(path_));
}

TEST_P(ImageFormatTest, TruncatedImageIsNot) {
  WriteImage(path_);
  const auto size = std::filesystem::file_size(path_);
  CutEnd(path_, size / 3);
  EXPECT_FALSE(IsWholeImage(path_));
  std::filesystem::resize_file(path_, 4);
  EXPECT_FALSE(IsWholeImage(path_));
  std::filesystem::resize_file(path_, 0);
  EXPECT_FALSE(IsWholeImage(path_));
}

INSTANTIATE_TEST_SUITE_P(Formats, ImageFormatTest,
                         testing::Values("png", "jpg", "jpeg", "pgm", "tif", "tiff"));

TEST(ImageFileTest, LastByteOfPngAndJpegMatters) {
  const TemporaryFolder folder;
  for (const char* name : {"a.png", "a.jpg"}) {
    WriteImage(folder.Path() / name);
    CutEnd(folder.Path() / name, 1);
    EXPECT_FALSE(IsWholeImage(folder.Path() / name)) << name;
  }
}

TEST(ImageFileTest, PaddingBehindTheEndIsAllowed) {
  const TemporaryFolder folder;
  for (const char* name : {"a.png", "a.jpg"}) {
    WriteImage(folder.Path() / name);
    std::ofstream(folder.Path() / name, std::ios::app) << std::string(100, '\0');
    EXPECT_TRUE(IsWholeImage(folder.Path() / name)) << name;
  }
}

TEST(ImageFileTest, TextAndMissingFilesAreNoImages) {
  const TemporaryFolder folder;
  EXPECT_FALSE(IsWholeImage(folder.Write("a.png", "not an image at all\n")));
  EXPECT_FALSE(IsWholeImage(folder.Path() / "none.png"));
  EXPECT_FALSE(IsWholeImage(folder.Path()));
}

TEST(ImageFileTest, ListsImagesByNameAndNothingElse) {
  const TemporaryFolder folder;
  for (const char* name :
       {"b.PNG", "a.jpg", "c.tiff", "d.ppm", "._a.png", "notes.txt", "e", "sub.png/x.png"}) {
    folder.Write(name, "x");
  }
  std::vector<std::string> names;
  for (const auto& path : ListImages(folder.Path())) names.push_back(path.filename().string());
  EXPECT_THAT(names, testing::ElementsAre("a.jpg", "b.PNG", "c.tiff", "d.ppm"));
  EXPECT_TRUE(ListImages(folder.Path() / "none").empty());
}

}  // namespace
}  // namespace rigmap
