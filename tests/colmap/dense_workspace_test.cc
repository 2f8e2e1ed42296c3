#include "colmap/dense_workspace.h"

#include <gtest/gtest.h>

#include <cstring>
#include <stdexcept>

#include "core/error.h"
#include "core/file.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

const std::vector<float> kDepth{1.0F, 2.0F, 0.0F, 4.0F, 5.0F, 6.5F};    // three by two
const std::vector<float> kNormals{0.1F, 0.2F, 0.0F, 0.4F, 0.5F,  0.6F,  //
                                  0.0F, 0.0F, 0.0F, 0.0F, 0.0F,  0.0F,  //
                                  -1.F, -1.F, 0.0F, -1.F, -0.5F, -0.25F};

// What COLMAP takes for the values of a file, as long as it says.
std::vector<float> ValuesIn(const fs::path& path, const std::string& header) {
  const std::string text = ReadTextFile(path);
  EXPECT_EQ(text.substr(0, header.size()), header);
  std::vector<float> values((text.size() - header.size()) / sizeof(float));
  std::memcpy(values.data(), text.data() + header.size(), values.size() * sizeof(float));
  return values;
}

TEST(WriteStereoView, IsWhatColmapReads) {
  const TemporaryFolder folder;
  WriteStereoView({"left/7.png", 3, 2, kDepth, kNormals}, folder.Path());
  const fs::path stereo = folder.Path() / "stereo";
  EXPECT_EQ(ValuesIn(stereo / "depth_maps" / "left" / "7.png.geometric.bin", "3&2&1&"), kDepth);
  EXPECT_EQ(ValuesIn(stereo / "normal_maps" / "left" / "7.png.geometric.bin", "3&2&3&"), kNormals);
}

TEST(WriteStereoView, RefusesOtherSizes) {
  const TemporaryFolder folder;
  EXPECT_THROW(WriteStereoView({"7.png", 2, 2, kDepth, kNormals}, folder.Path()), std::logic_error);
  EXPECT_THROW(WriteStereoView({"7.png", 3, 2, kDepth, kDepth}, folder.Path()), std::logic_error);
}

TEST(WriteStereoView, NamesWhatCannotBeWritten) {
  const TemporaryFolder folder;
  const fs::path file = folder.Write("file", "text");
  EXPECT_THROW(WriteStereoView({"7.png", 3, 2, kDepth, kNormals}, file), DataError);
  EXPECT_THROW(WriteStereoLists({"7.png"}, file), DataError);
}

TEST(WriteStereoLists, NamesTheViewsInTheirOrder) {
  const TemporaryFolder folder;
  WriteStereoLists({"9.png", "8.png"}, folder.Path());
  const fs::path stereo = folder.Path() / "stereo";
  EXPECT_EQ(ReadTextFile(stereo / "fusion.cfg"), "9.png\n8.png\n");
  EXPECT_EQ(ReadTextFile(stereo / "patch-match.cfg"), "9.png\n__auto__, 20\n8.png\n__auto__, 20\n");
  EXPECT_TRUE(fs::is_directory(stereo / "consistency_graphs"));
}

}  // namespace
}  // namespace rigmap
