#include "dataset/internal/rock_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "core/error.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

constexpr const char* kFirst = "Rock Data/Rock Positions Traverse 1 and 2/";
constexpr const char* kThird = "Rock Data/Rock Positions Traverse 3/";

TEST(RockFile, FindsTheNorthingByItsSize) {
  const TemporaryFolder folder;
  for (const std::string text :
       {"595685.5 5785795.2\n\n595678.1\t5785790.5\r\n", "5785795.2 595685.5\n5785790.5 595678.1",
        "  5.956855e5 5.7857952e+06\n5.956781e5 5.7857905e+06\n"}) {
    const auto rocks = ReadRockFile(folder.Write("rocks.txt", text), "medium");
    ASSERT_EQ(rocks.size(), 2U) << text;
    EXPECT_EQ(rocks[0].kind, "medium");
    EXPECT_EQ(rocks[0].position.epsg, 32631);
    EXPECT_NEAR(rocks[0].position.northing_m, 5785795.2, 1e-6);
    EXPECT_NEAR(rocks[1].position.easting_m, 595678.1, 1e-6);
    EXPECT_NEAR(rocks[1].position.northing_m, 5785790.5, 1e-6);
  }
}

TEST(RockFile, IsOfTheZoneThatItsReaderSays) {
  const TemporaryFolder folder;
  const auto rocks =
      ReadRockFile(folder.Write("rocks.txt", "628100 7453500\n"), "small", {19, false});
  ASSERT_EQ(rocks.size(), 1U);
  EXPECT_EQ(rocks[0].position.epsg, 32719);
}

// The second row alone could be read either way.
TEST(RockFile, TakesRocksNearTheEquator) {
  const TemporaryFolder folder;
  const auto rocks =
      ReadRockFile(folder.Write("rocks.txt", "99990 453000\n100010 453000\n"), "small", {36, true});
  ASSERT_EQ(rocks.size(), 2U);
  EXPECT_EQ(rocks[0].position.northing_m, 99990);
  EXPECT_EQ(rocks[1].position.northing_m, 100010);
}

TEST(RockFile, NamesTheLineThatIsNoPosition) {
  const TemporaryFolder folder;
  for (const std::string bad : {"595685.5", "595685.5 5785795.2 1.0", "595685.5 five", "52.2 4.4",
                                "595685.5 595685.5", "5785795.2 595685.5"}) {
    const auto path = folder.Write("rocks.txt", "595685.5 5785795.2\n" + bad + "\n");
    const std::string message = MessageOf<DataError>([&] { ReadRockFile(path, "small"); });
    EXPECT_NE(message.find("rocks.txt:2: expected easting and northing"), std::string::npos)
        << message;
    EXPECT_NE(message.find("found '" + bad + "'"), std::string::npos) << message;
  }
}

TEST(RockFile, TakesTheListOfTheTraverse) {
  const TemporaryFolder folder;
  folder.Write(std::string(kFirst) + "small-rocks-traverse12.txt", "595001 5785001\n");
  const auto part_folder = folder.Path() / "Traverse1" / "Part1";
  const auto eastings = [&](std::optional<int> traverse) {
    std::vector<double> found;
    for (const auto& rock : ReadRockSurvey({part_folder, traverse, 1})) {
      found.push_back(rock.position.easting_m);
    }
    return found;
  };
  EXPECT_EQ(eastings({}), std::vector<double>{595001});  // the only list
  folder.Write(std::string(kThird) + "large-rocks-traverse3.txt", "595003 5785003\n");
  folder.Write(std::string(kThird) + "small-rocks-traverse3.txt", "595004 5785003\n");
  EXPECT_EQ(eastings(1), std::vector<double>{595001});
  EXPECT_EQ(eastings(2), std::vector<double>{595001});
  EXPECT_EQ(eastings(3), (std::vector<double>{595004, 595003}));
  EXPECT_TRUE(eastings({}).empty());  // which of two, nobody knows
  EXPECT_EQ(ReadRockSurvey({part_folder, 3, 1}).back().kind, "large");
}

TEST(RockFile, LooksBesideThePartAndItsTraverse) {
  const TemporaryFolder folder;
  EXPECT_TRUE(ReadRockSurvey({folder.Path() / "Part1", {}, 1}).empty());
  folder.Write(std::string(kThird) + "small-rocks-traverse3.txt", "595004 5785003\n");
  for (const char* part : {"Part1", "Traverse3/Part1"}) {
    EXPECT_EQ(ReadRockSurvey({folder.Path() / part, 3, 1}).size(), 1U) << part;
  }
}

TEST(RockFile, ReadsARenderedBeach) {
  const char* data = std::getenv("RIGMAP_DATA");
  if (data == nullptr) GTEST_SKIP() << "RIGMAP_DATA is not set";
  const auto root = std::filesystem::path(data) / "beach-dev";
  const auto rocks = ReadRockSurvey(SelectKatwijkPart(root, 3, 1));
  const auto count = [&](const std::string& kind) {
    return std::ranges::count(rocks, kind, &SurveyedLandmark::kind);
  };
  EXPECT_EQ(count("small"), 13);
  EXPECT_EQ(count("medium"), 9);
  EXPECT_EQ(count("large"), 6);
}

}  // namespace
}  // namespace rigmap
