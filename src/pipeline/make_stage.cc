#include "pipeline/internal/make_stage.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <filesystem>

#include "core/memory_peak.h"

namespace rigmap {

MadeStage MakeStage(const StageNode& stage, const std::string& key, StageContext context,
                    const StageNode::Inputs& inputs, const StageFiles& files) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  TakeLargestChild();  // of before
  MemoryPeak memory;
  Publication publication(context.root, stage.publishes);
  context.publication = &publication;
  MadeStage made;
  try {
    made.product = stage.make(context, inputs);
    if (stage.publish) stage.publish(publication, context, made.product, inputs);
    std::filesystem::remove_all(context.scratch);
    stage.keep(files.Product(stage.name, key), key, made.product);
  } catch (...) {
    files.Discard(stage);
    throw;
  }
  files.ForgetOlderProducts(stage.name, key);
  made.published.assign(publication.written().begin(), publication.written().end());
  made.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  made.peak_rss_mb = std::max(memory.Megabytes(), TakeLargestChild());
  spdlog::info("done, {:.3f} s", made.seconds);
  return made;
}

}  // namespace rigmap
