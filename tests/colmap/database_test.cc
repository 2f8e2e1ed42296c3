#include "colmap/database.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>

#include <fstream>

#include "core/error.h"
#include "core/file.h"
#include "tests/colmap/read_database.h"
#include "tests/colmap/rover_database.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;

DatabaseContent SmallContent() {
  DatabaseContent content;
  content.cameras = {
      {Eye::kLeft, LocCamRig().left.camera},
      {Eye::kRight, {.width = 640, .height = 480, .fx = 500, .fy = 501, .cx = 320, .cy = 240}}};
  content.images = {
      {{0, Eye::kLeft}, "left/1.png", {{0.0F, 0.0F}, {10.25F, 20.5F}, {1023.0F, 767.0F}}},
      {{0, Eye::kRight}, "right/1.png", {{5.0F, 6.0F}, {7.0F, 8.0F}}}};
  content.pairs = {{{0, Eye::kRight}, {0, Eye::kLeft}, {{0, 2}, {1, 0}}}};
  return content;
}

class WriteDatabaseTest : public testing::Test {
 protected:
  void Write(const DatabaseContent& content) {
    WriteDatabase(FindColmap(), content, path_, folder_.Path() / "log");
  }
  std::string Refusal(const DatabaseContent& content) {
    try {
      Write(content);
    } catch (const DataError& error) {
      return error.what();
    }
    return "nothing was thrown";
  }

  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_.Path() / "part" / "database.db";
};

TEST_F(WriteDatabaseTest, ComesBackAsItWas) {
  const DatabaseContent content = SmallContent();
  Write(content);
  const DatabaseContent read = ReadDatabase(path_);
  ASSERT_EQ(read.cameras.size(), 2u);
  EXPECT_EQ(read.cameras[0].camera.cx, content.cameras[0].camera.cx);
  EXPECT_EQ(read.cameras[0].camera.k2, content.cameras[0].camera.k2);
  EXPECT_EQ(read.cameras[1].camera.width, 640);
  EXPECT_TRUE(read.cameras[1].camera.IsPinhole());
  ASSERT_EQ(read.images.size(), 2u);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(read.images[i].ref, content.images[i].ref);
    EXPECT_EQ(read.images[i].name, content.images[i].name);
    EXPECT_EQ(read.images[i].keypoints, content.images[i].keypoints);
  }
}

TEST_F(WriteDatabaseTest, PutsTheSmallerIdFirst) {
  Write(SmallContent());
  const DatabaseContent read = ReadDatabase(path_);
  ASSERT_EQ(read.pairs.size(), 1u);
  EXPECT_EQ(read.pairs[0].image_a, (ImageRef{0, Eye::kLeft}));
  EXPECT_EQ(read.pairs[0].image_b, (ImageRef{0, Eye::kRight}));
  EXPECT_THAT(read.pairs[0].matches, ElementsAre(Pair(2, 0), Pair(0, 1)));
}

TEST_F(WriteDatabaseTest, HoldsWhatColmapExpects) {
  Write(SmallContent());
  SQLite::Database database(path_.string(), SQLite::OPEN_READONLY);
  const auto number = [&](const std::string& query) {
    return database.execAndGet(query).getInt64();
  };
  EXPECT_EQ(number("SELECT pair_id FROM two_view_geometries"), 2147483647LL * 1 + 2);
  EXPECT_EQ(number("SELECT pair_id FROM matches"), 2147483647LL * 1 + 2);
  EXPECT_EQ(number("SELECT config FROM two_view_geometries"), 2);
  EXPECT_EQ(number("SELECT COUNT(*) FROM two_view_geometries WHERE F IS NULL AND E IS NULL AND "
                   "H IS NULL AND qvec IS NULL AND tvec IS NULL"),
            1);
  EXPECT_EQ(number("SELECT model FROM cameras WHERE camera_id = 1"), 4);
  EXPECT_EQ(number("SELECT model FROM cameras WHERE camera_id = 2"), 1);
  EXPECT_EQ(number("SELECT MIN(prior_focal_length) FROM cameras"), 1);
  const auto blob = database.execAndGet("SELECT data FROM keypoints WHERE image_id = 1");
  ASSERT_EQ(blob.getBytes(), 24);
  EXPECT_EQ(static_cast<const float*>(blob.getBlob())[2], 10.75F);  // px, COLMAP's convention
}

TEST_F(WriteDatabaseTest, LeavesOneFileAndReplacesAnOldOne) {
  Write(RoverDatabase(MakeSyntheticRover({.frames = 2}), 1));
  Write(SmallContent());
  EXPECT_EQ(ReadDatabase(path_).images.size(), 2u);
  int files = 0;
  for ([[maybe_unused]] const auto& entry :
       std::filesystem::directory_iterator(path_.parent_path())) {
    ++files;
  }
  EXPECT_EQ(files, 1);
}

TEST_F(WriteDatabaseTest, AcceptsImagesAndPairsWithoutContent) {
  DatabaseContent content = SmallContent();
  content.images.push_back({{3, Eye::kLeft}, "left/2.png", {}});
  content.pairs.push_back({{0, Eye::kLeft}, {3, Eye::kLeft}, {}});
  Write(content);
  EXPECT_TRUE(ReadDatabase(path_).images[2].keypoints.empty());
}

TEST_F(WriteDatabaseTest, RefusesContradictions) {
  DatabaseContent content = SmallContent();
  content.pairs[0].matches.emplace_back(2, 0);  // image 2 has keypoints 0 and 1
  EXPECT_THAT(Refusal(content), HasSubstr("pair 2, 1"));
  content = SmallContent();
  content.pairs.push_back({{0, Eye::kLeft}, {1, Eye::kLeft}, {}});
  EXPECT_THAT(Refusal(content), HasSubstr("1 and 3"));
  content = SmallContent();
  content.cameras.pop_back();
  EXPECT_THAT(Refusal(content), HasSubstr("image 2: expected a known camera, found 2"));
  content = SmallContent();
  content.images[1].ref.frame = -1;
  EXPECT_THAT(Refusal(content), HasSubstr("found -1"));
  content = SmallContent();
  content.images[1].name = content.images[0].name;
  EXPECT_THAT(Refusal(content), HasSubstr(path_.string()));
  content = SmallContent();
  content.pairs.push_back({{0, Eye::kLeft}, {0, Eye::kRight}, {}});  // the same pair again
  EXPECT_THAT(Refusal(content), HasSubstr(path_.string()));
  EXPECT_FALSE(std::filesystem::exists(path_));
}

TEST_F(WriteDatabaseTest, RefusesALockedDatabase) {
  Write(SmallContent());
  SQLite::Database other(path_.string(), SQLite::OPEN_READWRITE);
  other.exec("BEGIN IMMEDIATE");
  const std::string message = Refusal(SmallContent());
  EXPECT_THAT(message, HasSubstr(path_.string()));
  EXPECT_THAT(message, HasSubstr("locked"));
  EXPECT_THROW(RequireUnlocked(path_), DataError);
  other.exec("ROLLBACK");
  RequireUnlocked(path_);
  RequireUnlocked(folder_.Path() / "none.db");
}

TEST_F(WriteDatabaseTest, LeavesNothingWhenTheToolMakesGarbage) {
  const auto program = folder_.Path() / "colmap";
  std::ofstream(program) << "#!/bin/sh\necho garbage > \"$3\"\n";
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  EXPECT_THROW(
      WriteDatabase({program.string(), "3.8"}, SmallContent(), path_, folder_.Path() / "log"),
      DataError);
  EXPECT_FALSE(std::filesystem::exists(path_));
  EXPECT_FALSE(std::filesystem::exists(path_.string() + ".unfinished"));
}

TEST_F(WriteDatabaseTest, NamesAColumnThatTheToolDidNotMake) {
  // A database_creator of another make, whose table of cameras lacks what we must fill.
  const auto tables = folder_.Path() / "tables.db";
  SQLite::Database(tables.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE)
      .exec(
          "CREATE TABLE cameras (camera_id INTEGER, model INTEGER, width INTEGER, "
          "height INTEGER, params BLOB)");
  const auto program = folder_.Path() / "colmap";
  std::ofstream(program) << "#!/bin/sh\ncp '" << tables.string() << "' \"$3\"\n";
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  try {
    WriteDatabase({program.string(), "3.8"}, SmallContent(), path_, folder_.Path() / "log");
    FAIL() << "expected a ToolError";
  } catch (const ToolError& error) {
    EXPECT_THAT(error.what(), HasSubstr("column prior_focal_length in table cameras"));
  }
}

}  // namespace
}  // namespace rigmap
