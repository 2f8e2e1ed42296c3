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

// "a, b or c".
std::string Alternatives(const std::vector<std::string>& names) {
  const auto last = names.end() - 1;
  return fmt::format("{}{}{}", fmt::join(names.begin(), last, ", "), names.size() > 1 ? " or " : "",
                     *last);
}

void RequireInRange(const std::string& where, const OptionField& field, double value) {
  if (field.range.Holds(value)) return;
  throw UsageError(
      fmt::format("{}: expected {}, found {}", where, field.range.Text(), OptionValueText(field)));
}

// Sets the field and throws UsageError if it may not have that value; `where` begins the message.
struct Assign {
  const YamlNode& node;
  const OptionField& field;
  const std::string& where;

  void operator()(int* value) const {
    *value = node.AsInt();
    RequireInRange(where, field, *value);
  }
  void operator()(double* value) const {
    *value = node.AsDouble();
    RequireInRange(where, field, *value);
  }
  void operator()(bool* value) const { *value = node.AsBool(); }
  void operator()(const OptionChoice& choice) const {
    const auto found = std::find(choice.names.begin(), choice.names.end(), node.AsString());
    if (found == choice.names.end()) {
      throw UsageError(
          fmt::format("{}: expected {}, found '{}'", where, AllowedText(field), node.AsString()));
    }
    choice.choose(static_cast<std::size_t>(found - choice.names.begin()));
  }
};

struct Format {
  std::string operator()(const int* value) const { return fmt::format("{}", *value); }
  std::string operator()(const double* value) const { return fmt::format("{}", *value); }
  std::string operator()(const bool* value) const { return *value ? "true" : "false"; }
  std::string operator()(const OptionChoice& choice) const { return choice.names[choice.index()]; }
};

}  // namespace

OptionFields JoinFields(std::initializer_list<OptionFields> parts) {
  OptionFields joined;
  for (const OptionFields& part : parts) joined.insert(joined.end(), part.begin(), part.end());
  return joined;
}

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
    YamlNode named = node;
    named.where = fmt::format("{}: option {}", node.where, name);
    std::visit(Assign{named, *field, named.where}, field->value);
  }
}

void SetOption(const std::string& section, const std::string& option, const std::string& value,
               const OptionFields& fields) {
  const OptionField* field = FindField(fields, option);
  if (!field) {
    throw UsageError(fmt::format("--set {}.{}: unknown option, expected one of {}", section, option,
                                 Names(fields)));
  }
  const std::string where = fmt::format("--set {}.{}", section, option);
  const YamlNode node{
      .kind = YamlNode::Kind::kScalar, .scalar = value, .items = {}, .entries = {}, .where = where};
  try {
    std::visit(Assign{node, *field, where}, field->value);
  } catch (const DataError& error) {
    throw UsageError(error.what());
  }
}

std::string OptionValueText(const OptionField& field) { return std::visit(Format{}, field.value); }

std::string AllowedText(const OptionField& field) {
  if (std::holds_alternative<bool*>(field.value)) return "true or false";
  const auto* choice = std::get_if<OptionChoice>(&field.value);
  return choice ? Alternatives(choice->names) : field.range.Text();
}

std::string WriteOptions(const OptionFields& fields) {
  std::string text;
  for (const auto& field : fields) {
    text += fmt::format("  {}: {}\n", field.name, OptionValueText(field));
  }
  return text;
}

void RequireInRange(const std::string& section, const OptionFields& fields) {
  for (const OptionField& field : fields) {
    const std::string where = fmt::format("option {}.{}", section, field.name);
    if (const auto* whole = std::get_if<int*>(&field.value)) RequireInRange(where, field, **whole);
    if (const auto* real = std::get_if<double*>(&field.value)) RequireInRange(where, field, **real);
  }
}

void RequireOption(bool holds, const std::string& name, const std::string& requirement,
                   double value) {
  if (!holds) {
    throw UsageError(fmt::format("option {}: expected {}, found {}", name, requirement, value));
  }
}

}  // namespace rigmap
