#include "dataset/internal/image_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

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

TEST(ImageFileTest, ListsLinksAlsoBrokenOnesButNoPipes) {
  const TemporaryFolder folder;
  folder.Write("a.png", "x");
  std::filesystem::create_symlink("a.png", folder.Path() / "b.png");
  std::filesystem::create_symlink("nowhere.png", folder.Path() / "c.png");
  ASSERT_EQ(mkfifo((folder.Path() / "d.png").c_str(), 0600), 0);
  std::vector<std::string> names;
  for (const auto& path : ListImages(folder.Path())) names.push_back(path.filename().string());
  EXPECT_THAT(names, testing::ElementsAre("a.png", "b.png", "c.png"));
}

}  // namespace
}  // namespace rigmap
