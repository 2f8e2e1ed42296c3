#include "export/ply_rows.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <limits>
#include <string>
#include <vector>

#include "core/error.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_file.h"

namespace rigmap {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class PlyRowsTest : public testing::Test {
 protected:
  // Vertices of three floats and a uchar, in an order of their own.
  std::filesystem::path Write(const std::vector<std::array<float, 3>>& vertices) {
    std::string bytes = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                        std::to_string(vertices.size()) +
                        "\nproperty float z\nproperty uchar mark\nproperty float x\n"
                        "property float y\nend_header\n";
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      const auto& [x, y, z] = vertices[i];
      Append(z, bytes);
      bytes += static_cast<char>(i % 256);
      Append(x, bytes);
      Append(y, bytes);
    }
    return WriteTestFile(folder_.Path() / "cloud.ply", bytes);
  }
  static void Append(float value, std::string& bytes) {
    const auto word = std::bit_cast<std::uint32_t>(value);
    for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(word >> shift);
  }

  TemporaryFolder folder_;
};

// More than a block holds.
TEST_F(PlyRowsTest, GivesEveryRowInOrder) {
  std::vector<std::array<float, 3>> vertices;
  for (int i = 0; i < 50'000; ++i) vertices.push_back({1.0F * i, 0.5F * i, -2.0F * i});
  PlyRows rows(Write(vertices));
  ASSERT_EQ(rows.size(), vertices.size());
  const auto columns = rows.At({"x", "y", "z"});
  const PlyProperty& mark = rows.At("mark");
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const char* row = rows.Next();
    const auto& [x, y, z] = vertices[i];
    ASSERT_EQ(rows.FinitePoint(columns), Eigen::Vector3f(x, y, z)) << i;
    ASSERT_EQ(PlyValue(mark, row), static_cast<double>(i % 256)) << i;
  }
}

TEST_F(PlyRowsTest, NamesWhatIsMissing) {
  const auto path = Write({{1.0F, 2.0F, 3.0F}});
  PlyRows rows(path);
  EXPECT_EQ(rows.Find("nx"), nullptr);
  EXPECT_THAT(MessageOf<DataError>([&] { rows.At("nx"); }),
              AllOf(HasSubstr(path.string()), HasSubstr("'nx'"), HasSubstr("z mark x y")));
}

TEST_F(PlyRowsTest, NamesTheVertexThatIsNowhere) {
  const float nowhere = std::numeric_limits<float>::infinity();
  PlyRows rows(Write({{1.0F, 2.0F, 3.0F}, {1.0F, nowhere, 3.0F}}));
  const auto columns = rows.At({"x", "y", "z"});
  rows.Next();
  rows.FinitePoint(columns);
  rows.Next();
  EXPECT_THAT(MessageOf<DataError>([&] { rows.FinitePoint(columns); }),
              AllOf(HasSubstr("y of vertex 1"), HasSubstr("inf")));
}

TEST_F(PlyRowsTest, RefusesAFileThatEndsTooEarly) {
  const auto path = Write({{1.0F, 2.0F, 3.0F}, {4.0F, 5.0F, 6.0F}});
  std::filesystem::resize_file(path, std::filesystem::file_size(path) - 1);
  EXPECT_THAT(MessageOf<DataError>([&] { PlyRows rows(path); }),
              AllOf(HasSubstr(path.string()), HasSubstr("expected 2 vertices of 13 bytes")));
  EXPECT_THROW(PlyRows(folder_.Path()), DataError);
  EXPECT_THROW(PlyRows(folder_.Path() / "none.ply"), DataError);
}

}  // namespace
}  // namespace rigmap
