#include "features/feature_store.h"

#include <gmock/gmock.h>

#include "core/artefact.h"
#include "core/error.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

class FeatureStoreTest : public testing::Test {
 protected:
  FeatureStoreTest() {
    for (int frame = 0; frame < 40; ++frame) {
      files_.push_back({folder_.Path() / std::to_string(frame), "key"});
      FrameFeatures features;
      features.stamp_ns = frame;
      // One at the left border, one in the middle.
      for (const double x : {1.0, 50.0}) {
        Feature feature;
        feature.left = {x, 10.0};
        features.features.push_back(feature);
      }
      features.descriptors.resize(2);
      features.patches.resize(2);
      WriteArtefact(files_.back().path, "key", features);
    }
  }

  TemporaryFolder folder_;
  std::vector<FeatureFile> files_;
};

TEST_F(FeatureStoreTest, GivesEachFrameItsOwn) {
  const FeatureStore store(files_, {});
  EXPECT_EQ(store.frame_count(), 40);
  const FeatureSource source = store.AsSource();
  for (const int frame : {0, 39, 5, 0, 20}) EXPECT_EQ(source(frame).stamp_ns, frame);
  EXPECT_EQ(store.Get(3).features.size(), 2U);
}

TEST_F(FeatureStoreTest, KeepsTheFramesUsedLast) {
  const FeatureStore store(files_, {});
  for (int frame = 0; frame < 40; ++frame) store.Get(frame);
  for (const FeatureFile& file : files_) std::filesystem::remove(file.path);
  EXPECT_EQ(store.Get(39).stamp_ns, 39);
  EXPECT_THROW(store.Get(0), DataError);
}

TEST_F(FeatureStoreTest, LeavesOutWhatBelongsToTheRig) {
  RigFixedCells cells{.cell_px = 10, .columns = 10, .fixed = std::vector<std::uint8_t>(100, 0)};
  cells.fixed[10] = 1;  // column 0, row 1
  const FeatureStore store(files_, cells);
  for (int time = 0; time < 2; ++time) {  // read, and kept
    const FrameFeatures features = store.Get(7);
    ASSERT_EQ(features.features.size(), 1U);
    EXPECT_EQ(features.features[0].left.x(), 50.0);
    EXPECT_EQ(features.descriptors.size(), 1U);
  }
}

TEST_F(FeatureStoreTest, SaysWhichFileIsDamaged) {
  std::filesystem::resize_file(files_[2].path, 20);
  const FeatureStore store(files_, {});
  try {
    store.Get(2);
    ADD_FAILURE() << "a damaged file was read";
  } catch (const DataError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr(files_[2].path.string()));
  }
}

}  // namespace
}  // namespace rigmap
