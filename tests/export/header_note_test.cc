#include "export/header_note.h"

#include <gtest/gtest.h>

#include <sstream>

#include "core/error.h"
#include "core/file.h"
#include "export/ply.h"
#include "export/tum.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

std::string Cloud() {
  std::ostringstream stream;
  PlyWriter writer(stream);
  // Bytes that look like anything: line ends, comments.
  PointCloud points(3);
  for (SurfacePoint& point : points) point.rgb = {'\n', '#', '\r'};
  writer.Write(points);
  writer.Finish();
  return stream.str();
}

const std::string kTum = "1.000000000 0 0 0 0 0 0 1\n";

TEST(SetHeaderNote, StandsInTheFirstLineOfATrajectory) {
  const TemporaryFolder folder;
  const auto path = folder.Write("a.tum", kTum);
  SetHeaderNote(path, "not trusted: a");
  EXPECT_EQ(ReadTextFile(path), "# not trusted: a\n" + kTum);
  EXPECT_EQ(ReadTum(path).size(), 1U);
  SetHeaderNote(path, "not trusted: another reason");
  EXPECT_EQ(ReadTextFile(path), "# not trusted: another reason\n" + kTum);
  SetHeaderNote(path, "");
  EXPECT_EQ(ReadTextFile(path), kTum);
}

TEST(SetHeaderNote, LeavesOtherCommentsAlone) {
  const TemporaryFolder folder;
  const std::string text = "# The rig of a.yaml.\nleft: {}\n";
  const auto path = folder.Write("rig.yaml", text);
  SetHeaderNote(path, "not trusted: a");
  EXPECT_EQ(ReadTextFile(path), "# not trusted: a\n" + text);
  SetHeaderNote(path, "");
  EXPECT_EQ(ReadTextFile(path), text);
}

TEST(SetHeaderNote, IsACommentOfACloudThatReadsAsBefore) {
  const TemporaryFolder folder;
  const std::string cloud = Cloud();
  const auto path = folder.Write("a.ply", cloud);
  SetHeaderNote(path, "not trusted: a");
  const std::string noted = ReadTextFile(path);
  EXPECT_TRUE(noted.starts_with("ply\nformat binary_little_endian 1.0\ncomment not trusted: a\n"));
  EXPECT_EQ(noted.size(), cloud.size() + 23);
  EXPECT_EQ(ReadPly(path).size(), 3U);
  SetHeaderNote(path, "");
  EXPECT_TRUE(ReadTextFile(path) == cloud);
}

TEST(SetHeaderNote, DoesNotTouchWhatIsAsItShouldBe) {
  const TemporaryFolder folder;
  const auto path = folder.Write("a.tum", kTum);
  const auto long_ago = std::filesystem::file_time_type::clock::now() - std::chrono::hours(1);
  std::filesystem::last_write_time(path, long_ago);
  SetHeaderNote(path, "");
  EXPECT_EQ(std::filesystem::last_write_time(path), long_ago);
}

TEST(SetHeaderNote, OfAnEmptyFileIsAllThereIs) {
  const TemporaryFolder folder;
  const auto path = folder.Write("a.tum", "");
  SetHeaderNote(path, "not trusted: a");
  EXPECT_EQ(ReadTextFile(path), "# not trusted: a\n");
  SetHeaderNote(path, "");
  EXPECT_EQ(ReadTextFile(path), "");
  EXPECT_THROW(SetHeaderNote(folder.Path() / "missing.tum", "not trusted: a"), DataError);
}

}  // namespace
}  // namespace rigmap
