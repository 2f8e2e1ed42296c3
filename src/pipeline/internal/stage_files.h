// The files that stages keep in an output folder beside what they publish.
#pragma once

#include <filesystem>
#include <string>

#include "pipeline/stage_graph.h"

namespace rigmap {

class StageFiles {
 public:
  explicit StageFiles(std::filesystem::path root) : root_(std::move(root)) {}

  // What the stage of that name has made with that key.
  std::filesystem::path Product(const std::string& stage, const std::string& key) const;
  std::filesystem::path Log(const std::string& stage) const;
  std::filesystem::path Scratch(const std::string& stage) const;

  // Of all stages: what a run that was killed has left.
  void RemoveScratch() const;
  // What a stage that failed has left, as far as it can be removed: the failure that led here
  // matters more.
  void Discard(const StageNode& stage) const;
  // Keeps the product with that key and the latest other one: this recipe's, and another's.
  void ForgetOlderProducts(const std::string& stage, const std::string& key) const;

 private:
  std::filesystem::path root_;
};

}  // namespace rigmap
