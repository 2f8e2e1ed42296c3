// Options of a stage: a struct with in-class defaults that declares each of its fields once.
// Checks, reading and writing, the keys of stages, config/default.yaml and docs/options.md come
// from that.
//
//   struct ScaleOptions {
//     static constexpr const char* kSection = "scale";
//     double min_tolerated_share = 0.01;
//     OptionFields Fields() {
//       return {{"min_tolerated_share", &min_tolerated_share, "", AtLeast(0.0), "Why 0.01."}};
//     }
//     void RequireRelations() const;  // only where one option limits another; throws UsageError
//   };
#pragma once

#include <functional>
#include <initializer_list>
#include <string>
#include <variant>
#include <vector>

#include "core/enum_names.h"
#include "core/option_range.h"
#include "core/yaml.h"

namespace rigmap {

// A field that is one of an enumeration.
struct OptionChoice {
  std::vector<std::string> names;  // as NamesOf
  std::function<std::size_t()> index;
  std::function<void(std::size_t)> choose;
};

template <class Enum>
OptionChoice ChoiceOf(Enum* field) {
  const auto names = NamesOf(Enum{});
  return {{names.begin(), names.end()},
          [field] { return static_cast<std::size_t>(*field); },
          [field](std::size_t index) { *field = static_cast<Enum>(index); }};
}

struct OptionField {
  std::string name;
  std::variant<int*, double*, bool*, OptionChoice> value;
  std::string unit{};    // empty for counts, shares, ratios, flags and choices
  OptionRange range{};   // of numbers
  std::string reason{};  // what it does and why it has its default: whole sentences
};
using OptionFields = std::vector<OptionField>;

// A section of the YAML file.
struct OptionSection {
  std::string name;
  std::string about;  // a sentence or more
  OptionFields fields;
};

// The fields of several structs, in this order.
OptionFields JoinFields(std::initializer_list<OptionFields> parts);

// Sets each field that `section` names. A wrong kind of value or an unknown key is a DataError with
// its line, a value that is not allowed a UsageError with its line.
void ReadOptions(const YamlNode& section, const OptionFields& fields);

// Sets one field from text, as `--set section.option=value` gives it. Throws UsageError.
void SetOption(const std::string& section, const std::string& option, const std::string& value,
               const OptionFields& fields);

// "0.01", "true", "seeded": numbers so that they read back to the same value.
std::string OptionValueText(const OptionField& field);
// What the field may be: "0 to 1", "sgm or bm", "true or false".
std::string AllowedText(const OptionField& field);

// One "  name: value" line per field. The text is also what a stage's key is taken from.
std::string WriteOptions(const OptionFields& fields);

// The same of a struct of options.
template <class Options>
std::string OptionsText(const Options& options) {
  Options copy = options;
  return WriteOptions(copy.Fields());
}

// Throws UsageError "option SECTION.NAME: expected ALLOWED, found VALUE" for the first field out of
// its range.
void RequireInRange(const std::string& section, const OptionFields& fields);

// Ranges of all fields, and what limits one by another.
template <class Options>
void RequireValid(const Options& options) {
  Options copy = options;
  RequireInRange(Options::kSection, copy.Fields());
  if constexpr (requires { options.RequireRelations(); }) options.RequireRelations();
}

// Throws UsageError "option NAME: expected REQUIREMENT, found VALUE" unless `holds`.
void RequireOption(bool holds, const std::string& name, const std::string& requirement,
                   double value);

}  // namespace rigmap
