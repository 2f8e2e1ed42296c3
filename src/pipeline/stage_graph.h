// A recipe as a graph: which stage takes what of which others.
#pragma once

#include <any>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "core/artefact.h"
#include "core/options.h"
#include "pipeline/stage.h"

namespace rigmap {

// A product that is, or will be, there: what other stages are given to take.
template <class Product>
struct Node {
  std::size_t index = 0;
};

// The option structs that a stage is to read.
template <class... Options>
std::tuple<Options...> Reading(const Options&... options) {
  return {options...};
}

// One node with its types taken away. Products travel as std::shared_ptr<const Product> in `any`.
struct StageNode {
  enum class Kind {
    kSource,  // given from outside, with a key of its own
    kView,    // another form of what is there; nothing is kept or said of it
    kStage,
    kCheck
  };
  using Inputs = std::vector<std::any>;

  Kind kind = Kind::kStage;
  std::string name;      // of sources, stages and checks
  std::string about;     // of stages and checks
  std::string identity;  // of code and options; of a source its key, once it was opened
  std::vector<std::size_t> inputs;
  std::vector<std::string> reads;  // options, as "section.name"
  std::vector<std::string> publishes;
  bool waits_for_child = false;
  // A source: opens it, and says its key. Throws if it is not to be had.
  std::function<std::pair<std::string, std::any>()> open;
  std::function<std::any(const StageContext&, const Inputs&)> make;
  std::function<void(Publication&, const StageContext&, const std::any&, const Inputs&)> publish;
  std::function<bool(const StageContext&, const std::any&)> is_whole;
  std::function<Report(const std::any&, const Inputs&)> report;
  std::function<void(const std::filesystem::path&, const std::string& key, const std::any&)> keep;
  // The product kept with that key; empty if there is none.
  std::function<std::any(const std::filesystem::path&, const std::string& key)> load;
};

// Nodes in an order in which each stands behind all that it takes.
class StageGraph {
 public:
  // What is given from outside. `open` is called once, when it is first needed, and returns the
  // value with a text that changes whenever it does.
  template <class Value>
  Node<Value> AddSource(std::string name, std::function<std::pair<std::string, Value>()> open,
                        Report (*report)(const Value&) = nullptr) {
    StageNode node{.kind = StageNode::Kind::kSource, .name = std::move(name)};
    node.open = [open = std::move(open)]() -> std::pair<std::string, std::any> {
      auto [key, value] = open();
      return {std::move(key), Pack(std::move(value))};
    };
    if (report) {
      node.report = [report](const std::any& value, const StageNode::Inputs&) {
        return report(Unpack<Value>(value));
      };
    }
    return {Add(std::move(node))};
  }

  // `options` are those that the stage reads, whole structs of core/options.h.
  template <class Product, class... Inputs, class... Options>
  Node<Product> AddStage(const Stage<Product, Takes<Inputs...>, Reads<Options...>>& stage,
                         const std::tuple<Options...>& options, Node<Inputs>... inputs) {
    StageNode node{.kind = StageNode::Kind::kStage,
                   .name = stage.name,
                   .about = stage.about,
                   .identity = Identity(stage.name, stage.code, options),
                   .inputs = {inputs.index...},
                   .reads = NamesIn(options),
                   .publishes = stage.publishes,
                   .waits_for_child = stage.waits_for_child};
    node.make = [make = stage.make, options](const StageContext& context,
                                             const StageNode::Inputs& values) {
      return Pack(CallWith<Inputs...>(values, [&](const Inputs&... input) {
        return std::apply(
            [&](const Options&... option) { return make(context, input..., option...); }, options);
      }));
    };
    if (stage.publish) {
      node.publish = [publish = stage.publish](Publication& publication,
                                               const StageContext& context, const std::any& product,
                                               const StageNode::Inputs& values) {
        CallWith<Inputs...>(values, [&](const Inputs&... input) {
          publish(publication, context, Unpack<Product>(product), input...);
        });
      };
    }
    if (stage.is_whole) {
      node.is_whole = [is_whole = stage.is_whole](const StageContext& context,
                                                  const std::any& product) {
        return is_whole(context, Unpack<Product>(product));
      };
    }
    if (stage.report) {
      node.report = [report = stage.report](const std::any& product,
                                            const StageNode::Inputs& values) {
        return CallWith<Inputs...>(values, [&](const Inputs&... input) {
          return report(Unpack<Product>(product), input...);
        });
      };
    }
    node.keep = [](const std::filesystem::path& path, const std::string& key,
                   const std::any& product) { WriteArtefact(path, key, Unpack<Product>(product)); };
    node.load = [](const std::filesystem::path& path, const std::string& key) {
      auto product = ReadArtefact<Product>(path, key);
      return product ? Pack(std::move(*product)) : std::any();
    };
    return {Add(std::move(node))};
  }

  // What it reports may be taken by others.
  template <class... Inputs, class... Options>
  Node<Report> AddCheck(const Check<Takes<Inputs...>, Reads<Options...>>& check,
                        const std::tuple<Options...>& options, Node<Inputs>... inputs) {
    StageNode node{.kind = StageNode::Kind::kCheck,
                   .name = check.name,
                   .about = check.about,
                   .identity = Identity(check.name, check.code, options),
                   .inputs = {inputs.index...},
                   .reads = NamesIn(options)};
    node.make = [make = check.make, options](const StageContext&, const StageNode::Inputs& values) {
      return Pack(CallWith<Inputs...>(values, [&](const Inputs&... input) {
        return std::apply([&](const Options&... option) { return make(input..., option...); },
                          options);
      }));
    };
    node.report = [](const std::any& product, const StageNode::Inputs&) {
      return Unpack<Report>(product);
    };
    return {Add(std::move(node))};
  }

  // `view` makes another form of its inputs, quickly; it is made anew in each run that needs it.
  template <class Product, class... Inputs>
  Node<Product> AddView(Product (*view)(const StageContext&, const Inputs&...),
                        Node<Inputs>... inputs) {
    StageNode node{.kind = StageNode::Kind::kView, .inputs = {inputs.index...}};
    node.make = [view](const StageContext& context, const StageNode::Inputs& values) {
      return Pack(CallWith<Inputs...>(
          values, [&](const Inputs&... input) { return view(context, input...); }));
    };
    return {Add(std::move(node))};
  }

  const std::vector<StageNode>& nodes() const { return nodes_; }
  // Names for --until and --from, in order: of stages, and of sources that report.
  std::vector<std::string> StageNames() const;
  // Everything that any stage may publish.
  std::vector<std::string> Outputs() const;
  // The node of that name. Throws std::logic_error if there is none.
  std::size_t IndexOf(const std::string& name) const;
  // What must be in memory to make it: its inputs, and those of the views among these.
  std::vector<std::size_t> Needs(std::size_t index) const;
  // True for each node that `index` depends on, itself included; or that depends on it.
  std::vector<bool> Ancestors(std::size_t index) const;
  std::vector<bool> Descendants(std::size_t index) const;

  // As products travel.
  template <class Value>
  static std::any Pack(Value value) {
    return std::make_shared<const Value>(std::move(value));
  }

 private:
  template <class Value>
  static const Value& Unpack(const std::any& packed) {
    return *std::any_cast<const std::shared_ptr<const Value>&>(packed);
  }
  template <class... Inputs, class Function>
  static auto CallWith(const StageNode::Inputs& values, const Function& function) {
    return [&]<std::size_t... Index>(std::index_sequence<Index...>) {
      return function(Unpack<Inputs>(values[Index])...);
    }
    (std::index_sequence_for<Inputs...>());
  }
  template <class... Options>
  static std::string Identity(const std::string& name, std::string_view code,
                              const std::tuple<Options...>& options) {
    std::string text = name + "\n" + std::string(code) + "\n";
    std::apply([&](const Options&... option) { ((text += OptionsText(option) + "\n"), ...); },
               options);
    return text;
  }
  // What stands in no section, a recipe's own choice, has no name.
  template <class... Options>
  static std::vector<std::string> NamesIn(std::tuple<Options...> options) {
    std::vector<std::string> names;
    const auto add = [&](auto& option) {
      if constexpr (requires { option.kSection; }) {
        for (const OptionField& field : option.Fields()) {
          names.push_back(std::string(option.kSection) + "." + field.name);
        }
      }
    };
    std::apply([&](Options&... option) { (add(option), ...); }, options);
    return names;
  }
  std::size_t Add(StageNode node);

  std::vector<StageNode> nodes_;
};

}  // namespace rigmap
