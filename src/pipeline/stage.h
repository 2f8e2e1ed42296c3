// A stage: one named step of a recipe, declared once. What it takes, which options it reads, what
// it makes and what it publishes all stand in one value; its key, its record and its place in the
// documents follow from that.
#pragma once

#include <cereal/archives/binary.hpp>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace rigmap {

// What summary.json says of a stage: a share of that file, merged with those of the others.
using Report = nlohmann::ordered_json;

// Files and folders of a stage that users read. Names are relative to the output folder.
class Publication {
 public:
  // Only `declared` names may be written: they are what is removed before a stage is done anew.
  Publication(std::filesystem::path root, const std::vector<std::string>& declared)
      : root_(std::move(root)), declared_(declared.begin(), declared.end()) {}

  // Where `name` is to be written, atomically. Throws std::logic_error unless it is declared.
  std::filesystem::path Path(const std::string& name);
  // A whole file, or a folder that `fill` writes into, in place at once.
  void File(const std::string& name, const std::function<void(std::ostream&)>& write);
  void Folder(const std::string& name,
              const std::function<void(const std::filesystem::path&)>& fill);

  const std::set<std::string>& written() const { return written_; }

 private:
  std::filesystem::path root_;
  std::set<std::string> declared_, written_;
};

// What a stage may know beside what it takes and reads: nothing here changes a result.
struct StageContext {
  std::filesystem::path root;     // the output folder
  std::filesystem::path log;      // of this stage, also for a child process
  std::filesystem::path scratch;  // may be made; removed when the stage ends
  int threads = 1;
  int memory_mb = 2048;
  // False where --from asks for this stage anew: then what it keeps of single frames is not used.
  bool may_reuse = true;
  Publication* publication = nullptr;  // of the stages that publish while they make
};

template <class... Values>
struct Takes {};
template <class... Options>
struct Reads {};

template <class Product, class TakesThese, class ReadsThese>
struct Stage;

// Functions and no closures: what a stage does not take or read, it cannot know, so its key is
// whole. A product must be serialisable by cereal.
template <class Product, class... Inputs, class... Options>
struct Stage<Product, Takes<Inputs...>, Reads<Options...>> {
  std::string name;
  std::string about = {};  // what it makes, for the documents: no sentence, a phrase
  std::string_view code;   // CodeHere()
  Product (*make)(const StageContext&, const Inputs&..., const Options&...) = nullptr;
  // All that it may leave for users, relative to the output folder.
  std::vector<std::string> publishes = {};
  // Writes these from the product, made or kept. Without it a stage publishes while it makes, and
  // is made anew when something is missing.
  void (*publish)(Publication&, const StageContext&, const Product&, const Inputs&...) = nullptr;
  // Whether the files that a kept product names are there; without it, a product is whole by
  // itself.
  bool (*is_whole)(const StageContext&, const Product&) = nullptr;
  Report (*report)(const Product&, const Inputs&...) = nullptr;
  // It mostly waits for a child process that keeps one core busy: what does not take its product is
  // done meanwhile.
  bool waits_for_child = false;
};

// A check: what a finished product is worth. It is done whenever all that it takes is there, has no
// name for --until, and keeps nothing but what it reports, which others may take.
template <class TakesThese, class ReadsThese>
struct Check;

template <class... Inputs, class... Options>
struct Check<Takes<Inputs...>, Reads<Options...>> {
  std::string name;
  std::string_view code;
  Report (*make)(const Inputs&..., const Options&...) = nullptr;
  std::string about = {};  // what it asks, for the documents
};

}  // namespace rigmap
