#include <gmock/gmock.h>

#include <fstream>
#include <stdexcept>

#include "core/file.h"
#include "pipeline/stage.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

using testing::UnorderedElementsAre;

TEST(PublicationTest, WritesFilesAndFoldersAndRemembersThem) {
  const TemporaryFolder folder;
  Publication publication(folder.Path(), {"a.txt", "deep/b.txt", "c", "never.txt"});
  publication.File("a.txt", [](std::ostream& stream) { stream << "a"; });
  publication.File("deep/b.txt", [](std::ostream& stream) { stream << "b"; });
  publication.Folder(
      "c", [](const std::filesystem::path& inside) { std::ofstream(inside / "d.txt") << "d"; });
  EXPECT_EQ(ReadTextFile(folder.Path() / "a.txt"), "a");
  EXPECT_EQ(ReadTextFile(folder.Path() / "deep" / "b.txt"), "b");
  EXPECT_EQ(ReadTextFile(folder.Path() / "c" / "d.txt"), "d");
  EXPECT_THAT(publication.written(), UnorderedElementsAre("a.txt", "deep/b.txt", "c"));
}

// What is not declared would not be removed when the stage is done anew.
TEST(PublicationTest, RefusesWhatWasNotDeclared) {
  const TemporaryFolder folder;
  Publication publication(folder.Path(), {"a.txt"});
  EXPECT_THROW(publication.Path("b.txt"), std::logic_error);
  EXPECT_TRUE(publication.written().empty());
}

}  // namespace
}  // namespace rigmap
