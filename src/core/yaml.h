// YAML documents as plain values that remember where they stood, so that every complaint can name
// file and line. The only place that knows the YAML library.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

namespace rigmap {

struct YamlNode {
  enum class Kind { kNull, kScalar, kSequence, kMap };

  Kind kind = Kind::kNull;
  std::string scalar;                                     // kScalar: the text as written
  std::vector<YamlNode> items;                            // kSequence
  std::vector<std::pair<std::string, YamlNode>> entries;  // kMap, in order of appearance
  std::string where;                                      // "file:line"

  // The value under `key`, or nullptr. Throws DataError unless this is a map (or null).
  const YamlNode* Find(const std::string& key) const;
  // As Find, but a missing key is a DataError.
  const YamlNode& At(const std::string& key) const;
  // Throws DataError naming the line of the first key that is not in `known`.
  void RequireKeys(std::initializer_list<const char*> known) const;

  // Conversions throw DataError naming file, line, what was expected and what was found.
  double AsDouble() const;  // finite
  int AsInt() const;
  bool AsBool() const;
  const std::string& AsString() const;
  std::vector<double> AsDoubles(std::size_t expected_count) const;
};

// Throws DataError when the file is missing, is not YAML, repeats a key, is nested deeper than 20
// or holds more than 100,000 values, those that aliases repeat counted each time.
YamlNode ReadYaml(const std::filesystem::path& path);
// `name` stands for the file in messages.
YamlNode ParseYaml(const std::string& text, const std::string& name);

// `text` as a double-quoted YAML scalar on one line, which reads back to the same text.
std::string QuoteYaml(const std::string& text);

}  // namespace rigmap
