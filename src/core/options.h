// Options of a stage: a struct with defaults that lists its fields once, for reading, writing and
// hashing alike.
//
//   struct ScaleOptions {
//     double max_spread = 0.02;  // why
//     OptionFields Fields() { return {{"max_spread", &max_spread}}; }
//     void Validate() const;     // throws UsageError with a sentence
//   };
#pragma once

#include <initializer_list>
#include <string>
#include <variant>
#include <vector>

#include "core/yaml.h"

namespace rigmap {

struct OptionField {
  std::string name;
  std::variant<int*, double*, bool*, std::string*> value;
};
using OptionFields = std::vector<OptionField>;

// Sets each field that `section` names; an unknown key is a DataError with its line.
void ReadOptions(const YamlNode& section, const OptionFields& fields);

// Sets one field from text, as `--set stage.option=value` gives it. Throws UsageError.
void SetOption(const std::string& stage, const std::string& option, const std::string& value,
               const OptionFields& fields);

// One "  name: value" line per field, numbers so that they read back to the same value. The text
// is also what an artefact's key is taken from.
std::string WriteOptions(const OptionFields& fields);

// The same of a struct of options.
template <class Options>
std::string OptionsText(const Options& options) {
  Options copy = options;
  return WriteOptions(copy.Fields());
}

// The fields of several structs, in this order.
OptionFields JoinFields(std::initializer_list<OptionFields> parts);

// Throws UsageError "option NAME: expected REQUIREMENT, found VALUE" unless `holds`.
void RequireOption(bool holds, const std::string& name, const std::string& requirement,
                   double value);

}  // namespace rigmap
