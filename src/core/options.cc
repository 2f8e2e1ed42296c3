#include "core/options.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"

namespace rigmap {
namespace {

const OptionField* FindField(const OptionFields& fields, const std::string& name) {
  const auto it = std::find_if(fields.begin(), fields.end(),
                               [&](const OptionField& field) { return field.name == name; });
  return it == fields.end() ? nullptr : &*it;
}

std::string Names(const OptionFields& fields) {
  std::vector<std::string> names;
  for (const auto& field : fields) names.push_back(field.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

struct Assign {
  const YamlNode& node;
  void operator()(int* value) const { *value = node.AsInt(); }
  void operator()(double* value) const { *value = node.AsDouble(); }
  void operator()(bool* value) const { *value = node.AsBool(); }
  void operator()(std::string* value) const { *value = node.AsString(); }
};

struct Format {
  std::string operator()(const int* value) const { return fmt::format("{}", *value); }
  std::string operator()(const double* value) const { return fmt::format("{}", *value); }
  std::string operator()(const bool* value) const { return *value ? "true" : "false"; }
  std::string operator()(const std::string* value) const { return QuoteYaml(*value); }
};

}  // namespace

void ReadOptions(const YamlNode& section, const OptionFields& fields) {
  if (section.kind != YamlNode::Kind::kMap && section.kind != YamlNode::Kind::kNull) {
    throw DataError(fmt::format("{}: expected a map of options, found {}", section.where,
                                section.kind == YamlNode::Kind::kScalar
                                    ? fmt::format("'{}'", section.scalar)
                                    : fmt::format("a list of {}", section.items.size())));
  }
  for (const auto& [name, node] : section.entries) {
    const OptionField* field = FindField(fields, name);
    if (!field) {
      throw DataError(fmt::format("{}: unknown option '{}', expected one of {}", node.where, name,
                                  Names(fields)));
    }
    std::visit(Assign{node}, field->value);
  }
}

void SetOption(const std::string& stage, const std::string& option, const std::string& value,
               const OptionFields& fields) {
  const OptionField* field = FindField(fields, option);
  if (!field) {
    throw UsageError(fmt::format("--set {}.{}: unknown option, expected one of {}", stage, option,
                                 Names(fields)));
  }
  YamlNode node{.kind = YamlNode::Kind::kScalar,
                .scalar = value,
                .items = {},
                .entries = {},
                .where = fmt::format("--set {}.{}", stage, option)};
  try {
    std::visit(Assign{node}, field->value);
  } catch (const DataError& error) {
    throw UsageError(error.what());
  }
}

std::string WriteOptions(const OptionFields& fields) {
  std::string text;
  for (const auto& field : fields) {
    text += fmt::format("  {}: {}\n", field.name, std::visit(Format{}, field.value));
  }
  return text;
}

OptionFields JoinFields(std::initializer_list<OptionFields> parts) {
  OptionFields joined;
  for (const OptionFields& part : parts) joined.insert(joined.end(), part.begin(), part.end());
  return joined;
}

void RequireOption(bool holds, const std::string& name, const std::string& requirement,
                   double value) {
  if (!holds) {
    throw UsageError(fmt::format("option {}: expected {}, found {}", name, requirement, value));
  }
}

}  // namespace rigmap
