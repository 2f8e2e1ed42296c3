#include "colmap/model_io.h"

#include <gmock/gmock.h>

#include <cstring>
#include <fstream>
#include <random>

#include "colmap/installation.h"
#include "colmap/internal/process.h"
#include "core/error.h"
#include "core/file.h"
#include "tests/support/synthetic_rover.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

using testing::HasSubstr;

const std::vector<std::string> kFiles{"cameras.bin", "images.bin", "points3D.bin"};

// Two images that see the same points, and one keypoint each that sees none.
SparseModel RandomModel(int points) {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  SparseModel model;
  model.cameras = {
      {Eye::kLeft, LocCamRig().left.camera},
      {Eye::kRight, {.width = 640, .height = 480, .fx = 500, .fy = 501, .cx = 319.5, .cy = 240}}};
  model.images.resize(2);
  for (int i = 0; i < 2; ++i) {
    SparseImage& image = model.images[i];
    image.ref = {2, model.cameras[i].eye};
    image.name = i == 0 ? "left/1448551416619000000.png" : "right/1448551416619000000.png";
    image.camera_from_model.rotation =
        ExpRotation({unit(random), unit(random), unit(random)}).normalized();
    image.camera_from_model.translation = {unit(random), unit(random), unit(random)};
    image.keypoints.push_back({{1.0, 2.0}, std::nullopt});
  }
  for (int i = 0; i < points; ++i) {
    SparsePoint point;
    point.id = 100 + static_cast<std::uint64_t>(i);
    point.x_in_model = {unit(random), unit(random), unit(random)};
    point.rgb = {static_cast<std::uint8_t>(i), 20, 255};
    point.error_px = 0.5 + 0.1 * unit(random);
    for (auto& image : model.images) {
      point.track.push_back({image.ref, static_cast<std::uint32_t>(image.keypoints.size())});
      const double x = 300.0 + 200.0 * unit(random), y = 300.0 + 200.0 * unit(random);
      image.keypoints.push_back({{x, y}, point.id});
    }
    model.points.push_back(std::move(point));
  }
  return model;
}

std::string Bytes(const std::filesystem::path& folder) {
  std::string bytes;
  for (const auto& file : kFiles) bytes += ReadTextFile(folder / file);
  return bytes;
}

std::string Refusal(const std::filesystem::path& folder) {
  try {
    ReadModel(folder);
  } catch (const DataError& error) {
    return error.what();
  }
  return "nothing was thrown";
}

TEST(ModelIo, LensWithK3IsCOLMAPsFullOpenCv) {
  const TemporaryFolder folder;
  SparseModel model = RandomModel(10);
  model.cameras[0].camera.k3 = 0.03;
  WriteModel(model, folder.Path() / "0");
  const Camera read = ReadModel(folder.Path() / "0").cameras[0].camera;
  EXPECT_EQ(read.k3, 0.03);
  EXPECT_EQ(read.p2, model.cameras[0].camera.p2);
  EXPECT_EQ(ReadTextFile(folder.Path() / "0" / "cameras.bin")[12], 6);  // behind count and id
}

TEST(ModelIo, ComesBackAsItWas) {
  const TemporaryFolder folder;
  const SparseModel model = RandomModel(10);
  WriteModel(model, folder.Path() / "0");
  const SparseModel read = ReadModel(folder.Path() / "0");
  ASSERT_EQ(read.cameras.size(), 2u);
  EXPECT_EQ(read.cameras[0].eye, Eye::kLeft);
  EXPECT_EQ(read.cameras[0].camera.cy, model.cameras[0].camera.cy);
  EXPECT_EQ(read.cameras[0].camera.k1, model.cameras[0].camera.k1);
  EXPECT_TRUE(read.cameras[1].camera.IsPinhole());
  ASSERT_EQ(read.images.size(), 2u);
  EXPECT_EQ(read.images[1].name, model.images[1].name);
  EXPECT_EQ(read.images[1].ref, (ImageRef{2, Eye::kRight}));
  EXPECT_EQ(read.images[1].camera_from_model.rotation.coeffs(),
            model.images[1].camera_from_model.rotation.coeffs());
  EXPECT_EQ(read.images[1].camera_from_model.translation,
            model.images[1].camera_from_model.translation);
  ASSERT_EQ(read.images[0].keypoints.size(), 11u);
  EXPECT_FALSE(read.images[0].keypoints[0].point_id.has_value());
  EXPECT_EQ(read.images[0].keypoints[4].point_id, model.images[0].keypoints[4].point_id);
  EXPECT_NEAR((read.images[0].keypoints[4].pixel - model.images[0].keypoints[4].pixel).norm(), 0.0,
              1e-12);  // px
  ASSERT_EQ(read.points.size(), 10u);
  EXPECT_EQ(read.points[2].x_in_model, model.points[2].x_in_model);
  EXPECT_EQ(read.points[2].rgb, model.points[2].rgb);
  EXPECT_EQ(read.points[2].track[1].keypoint, model.points[2].track[1].keypoint);
}

TEST(ModelIo, ReadingAndWritingGivesEqualBytes) {
  const TemporaryFolder folder;
  WriteModel(RandomModel(50), folder.Path() / "a");
  WriteModel(ReadModel(folder.Path() / "a"), folder.Path() / "b");
  EXPECT_EQ(Bytes(folder.Path() / "a"), Bytes(folder.Path() / "b"));
}

TEST(ModelIo, PixelsInTheFilesAreColmaps) {
  const TemporaryFolder folder;
  WriteModel(RandomModel(0), folder.Path());
  const std::string cameras = ReadTextFile(folder.Path() / "cameras.bin");
  double cx = 0.0;
  std::memcpy(&cx, cameras.data() + 8 + 24 + 16, sizeof(cx));
  EXPECT_EQ(cx, LocCamRig().left.camera.cx + 0.5);
  const std::string images = ReadTextFile(folder.Path() / "images.bin");
  double x = 0.0;
  std::memcpy(&x, images.data() + images.size() - 24, sizeof(x));
  EXPECT_EQ(x, 1.5);
}

TEST(ModelIo, ColmapReadsIt) {
  const TemporaryFolder folder;
  WriteModel(RandomModel(25), folder.Path() / "0");
  std::string text;
  ProcessRequest request{.program = FindColmap().path,
                         .arguments = {"model_analyzer", "--path", (folder.Path() / "0").string()}};
  request.on_line = [&](const std::string& line) { text += line + "\n"; };
  EXPECT_TRUE(RunProcess(request).Succeeded());
  EXPECT_THAT(text, HasSubstr("Cameras: 2\nImages: 2\nRegistered images: 2\nPoints: 25\n"
                              "Observations: 50"));
}

TEST(ModelIo, ColmapsOwnFilesGiveEqualBytes) {
  const TemporaryFolder folder;
  WriteModel(RandomModel(25), folder.Path() / "0");
  std::filesystem::create_directories(folder.Path() / "1");
  RunTool({.program = FindColmap().path,
           .arguments = {"model_converter", "--input_path", (folder.Path() / "0").string(),
                         "--output_path", (folder.Path() / "1").string(), "--output_type", "BIN"}},
          "converting");
  WriteModel(ReadModel(folder.Path() / "1"), folder.Path() / "2");
  EXPECT_EQ(Bytes(folder.Path() / "1"), Bytes(folder.Path() / "2"));
  EXPECT_EQ(ReadModel(folder.Path() / "1").points.size(), 25u);
}

TEST(ModelIo, RefusesTruncatedFilesByName) {
  const TemporaryFolder folder;
  for (const auto& file : kFiles) {
    WriteModel(RandomModel(5), folder.Path());
    const auto size = std::filesystem::file_size(folder.Path() / file);
    for (const auto cut : {size - 1, size / 2, std::uintmax_t{9}, std::uintmax_t{3}}) {
      std::filesystem::resize_file(folder.Path() / file, cut);
      EXPECT_THAT(Refusal(folder.Path()), HasSubstr((folder.Path() / file).string()));
    }
    std::filesystem::remove(folder.Path() / file);
    EXPECT_THAT(Refusal(folder.Path()), HasSubstr((folder.Path() / file).string()));
    EXPECT_FALSE(HasModel(folder.Path()));
  }
}

TEST(ModelIo, RefusesLongerFilesAndAbsurdCounts) {
  const TemporaryFolder folder;
  WriteModel(RandomModel(5), folder.Path());
  std::ofstream(folder.Path() / "points3D.bin", std::ios::app) << 'x';
  EXPECT_THAT(Refusal(folder.Path()), HasSubstr("expected the end of the file"));
  const std::string count(8, '\x7f');
  std::ofstream(folder.Path() / "points3D.bin", std::ios::binary) << count;
  EXPECT_THAT(Refusal(folder.Path()), HasSubstr("points3D.bin"));
}

TEST(ModelIo, RefusesOtherCameraModelsByName) {
  const TemporaryFolder folder;
  WriteModel(RandomModel(5), folder.Path());
  std::fstream stream(folder.Path() / "cameras.bin",
                      std::ios::in | std::ios::out | std::ios::binary);
  stream.seekp(8 + 4);
  stream.put(2);
  stream.close();
  EXPECT_THAT(Refusal(folder.Path()), HasSubstr("SIMPLE_RADIAL (2)"));
}

TEST(ModelIo, RefusesNumbersThatAreNotFinite) {
  const TemporaryFolder folder;
  SparseModel model = RandomModel(5);
  model.images[0].camera_from_model.translation.x() = std::nan("");
  WriteModel(model, folder.Path());
  EXPECT_THAT(Refusal(folder.Path()), HasSubstr("images.bin: expected a finite number"));
}

// cameras.bin: count, then the id; images.bin: count, id, pose, camera.
TEST(ModelIo, NumbersImagesByFrameAndEye) {
  const TemporaryFolder folder;
  WriteModel(RandomModel(5), folder.Path());
  const auto number_at = [&](const char* file, std::size_t offset) {
    std::uint32_t number = 0;
    std::memcpy(&number, ReadTextFile(folder.Path() / file).data() + offset, sizeof(number));
    return number;
  };
  EXPECT_EQ(number_at("cameras.bin", 8), 1U);
  EXPECT_EQ(number_at("images.bin", 8), 5U);
  EXPECT_EQ(number_at("images.bin", 8 + 4 + 56), 1U);
}

TEST(ModelIo, RefusesCamerasAndImagesNumberedOtherwise) {
  const TemporaryFolder folder;
  const auto spoil = [&](const char* file, int offset, char id) {
    WriteModel(RandomModel(5), folder.Path());
    std::fstream stream(folder.Path() / file, std::ios::in | std::ios::out | std::ios::binary);
    stream.seekp(offset);
    stream.put(id);
    stream.close();
    return Refusal(folder.Path());
  };
  EXPECT_THAT(spoil("cameras.bin", 8, 3), HasSubstr("camera 1 (left) or 2 (right), found 3"));
  EXPECT_THAT(spoil("images.bin", 8, 0), HasSubstr("image ids from 1"));
  EXPECT_THAT(spoil("images.bin", 8 + 4 + 56, 2),
              HasSubstr("image 5 to be of camera 1, found camera 2"));
}

TEST(ModelIo, RefusesTracksOfWhatDoesNotExist) {
  const TemporaryFolder folder;
  SparseModel model = RandomModel(5);
  model.points[3].track[0].keypoint = 6;
  WriteModel(model, folder.Path());
  EXPECT_THAT(Refusal(folder.Path()), HasSubstr("point 103 names keypoint 6 of image 5"));
}

}  // namespace
}  // namespace rigmap
