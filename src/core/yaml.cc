#include "core/yaml.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

#include "core/error.h"
#include "core/file.h"

namespace rigmap {
namespace {

std::string Where(const std::string& name, const YAML::Mark& mark) {
  return mark.is_null() ? name : fmt::format("{}:{}", name, mark.line + 1);
}

// An alias may lead back to the node that holds it: what is nested deeper is refused.
constexpr int kMaxDepth = 20;
// Aliases of aliases make billions of values out of a few hundred bytes. The largest file that is
// ours is the rig of a pool: two hundred for each of its parts.
constexpr std::size_t kMaxNodes = 100'000;

// Copies a document; a value counts as often as aliases repeat it.
class Conversion {
 public:
  explicit Conversion(const std::string& name) : name_(name) {}

  YamlNode Convert(const YAML::Node& node, int depth = 0) {
    Count(node, depth);
    YamlNode result;
    result.where = Where(name_, node.Mark());
    if (node.IsScalar()) {
      result.kind = YamlNode::Kind::kScalar;
      result.scalar = node.Scalar();
    } else if (node.IsSequence()) {
      result.kind = YamlNode::Kind::kSequence;
      for (const auto& item : node) result.items.push_back(Convert(item, depth + 1));
    } else if (node.IsMap()) {
      result.kind = YamlNode::Kind::kMap;
      result.entries = Entries(node, depth);
    }
    return result;
  }

 private:
  void Count(const YAML::Node& node, int depth) {
    if (depth > kMaxDepth) {
      throw DataError(
          fmt::format("{}: nested deeper than {}", Where(name_, node.Mark()), kMaxDepth));
    }
    if (++count_ > kMaxNodes) {
      throw DataError(fmt::format(
          "{}: expected at most {} values, those that aliases repeat counted each time, found more",
          Where(name_, node.Mark()), kMaxNodes));
    }
  }

  std::vector<std::pair<std::string, YamlNode>> Entries(const YAML::Node& map, int depth) {
    std::vector<std::pair<std::string, YamlNode>> entries;
    std::set<std::string> seen;
    for (const auto& entry : map) {
      const auto key = entry.first.Scalar();
      const auto where = Where(name_, entry.first.Mark());
      if (!seen.insert(key).second) {
        throw DataError(fmt::format("{}: key '{}' stands twice", where, key));
      }
      entries.emplace_back(key, Convert(entry.second, depth + 1));
      entries.back().second.where = where;
    }
    return entries;
  }

  const std::string& name_;
  std::size_t count_ = 0;
};

std::string Describe(const YamlNode& node) {
  switch (node.kind) {
    case YamlNode::Kind::kNull:
      return "nothing";
    case YamlNode::Kind::kScalar:
      return fmt::format("'{}'", node.scalar);
    case YamlNode::Kind::kSequence:
      return fmt::format("a list of {}", node.items.size());
    case YamlNode::Kind::kMap:
      return "a map";
  }
  return "";
}

DataError Expected(const char* what, const YamlNode& node) {
  return DataError(fmt::format("{}: expected {}, found {}", node.where, what, Describe(node)));
}

}  // namespace

const YamlNode* YamlNode::Find(const std::string& key) const {
  if (kind == Kind::kNull) return nullptr;
  if (kind != Kind::kMap) throw Expected("a map", *this);
  const auto it = std::find_if(entries.begin(), entries.end(),
                               [&](const auto& entry) { return entry.first == key; });
  return it == entries.end() ? nullptr : &it->second;
}

const YamlNode& YamlNode::At(const std::string& key) const {
  const YamlNode* found = Find(key);
  if (!found) throw DataError(fmt::format("{}: key '{}' is missing", where, key));
  return *found;
}

void YamlNode::RequireKeys(std::initializer_list<const char*> known) const {
  if (kind == Kind::kNull) return;
  if (kind != Kind::kMap) throw Expected("a map", *this);
  for (const auto& [key, value] : entries) {
    const auto matches = [&](const char* name) { return key == name; };
    if (std::none_of(known.begin(), known.end(), matches)) {
      throw DataError(fmt::format("{}: unknown key '{}', expected one of {}", value.where, key,
                                  fmt::join(known, ", ")));
    }
  }
}

double YamlNode::AsDouble() const {
  double value = 0.0;
  const char* begin = scalar.data() + (!scalar.empty() && scalar.front() == '+' ? 1 : 0);
  const char* end = scalar.data() + scalar.size();
  const auto result = std::from_chars(begin, end, value);
  if (kind != Kind::kScalar || begin == end || result.ec != std::errc() || result.ptr != end ||
      !std::isfinite(value)) {
    throw Expected("a finite number", *this);
  }
  return value;
}

int YamlNode::AsInt() const {
  int value = 0;
  const char* end = scalar.data() + scalar.size();
  const auto result = std::from_chars(scalar.data(), end, value);
  if (kind != Kind::kScalar || scalar.empty() || result.ec != std::errc() || result.ptr != end) {
    throw Expected("an integer", *this);
  }
  return value;
}

bool YamlNode::AsBool() const {
  if (kind == Kind::kScalar && (scalar == "true" || scalar == "True")) return true;
  if (kind == Kind::kScalar && (scalar == "false" || scalar == "False")) return false;
  throw Expected("true or false", *this);
}

const std::string& YamlNode::AsString() const {
  if (kind != Kind::kScalar) throw Expected("text", *this);
  return scalar;
}

std::vector<double> YamlNode::AsDoubles(std::size_t expected_count) const {
  if (kind != Kind::kSequence || items.size() != expected_count) {
    throw Expected(fmt::format("a list of {} numbers", expected_count).c_str(), *this);
  }
  std::vector<double> values;
  for (const auto& item : items) values.push_back(item.AsDouble());
  return values;
}

YamlNode ReadYaml(const std::filesystem::path& path) {
  return ParseYaml(ReadTextFile(path), path.string());
}

YamlNode ParseYaml(const std::string& text, const std::string& name) {
  try {
    const std::vector<YAML::Node> documents = YAML::LoadAll(text);
    if (documents.size() > 1) {
      throw DataError(
          fmt::format("{}: expected one YAML document, found {}", name, documents.size()));
    }
    return Conversion(name).Convert(documents.empty() ? YAML::Node() : documents.front());
  } catch (const YAML::Exception& error) {
    throw DataError(fmt::format("{}: not valid YAML: {}", Where(name, error.mark), error.msg));
  }
}

std::string QuoteYaml(const std::string& text) {
  std::string quoted = "\"";
  for (const char letter : text) {
    const auto code = static_cast<unsigned char>(letter);
    if (letter == '"' || letter == '\\') {
      quoted += fmt::format("\\{}", letter);
    } else if (code < 0x20 || code == 0x7f) {
      quoted += fmt::format("\\x{:02x}", code);
    } else {
      quoted += letter;
    }
  }
  return quoted + '"';
}

}  // namespace rigmap
