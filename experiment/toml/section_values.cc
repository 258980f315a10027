#include <utility>

#include "experiment/toml/section_internal.h"
#include "experiment/toml/value_tables.h"

namespace mascot {

struct ValueTables::Content {
  /// What stood at a place before a change.
  struct Before {
    std::vector<Step> steps;
    toml::array node;  // empty: nothing did
  };

  toml::table root;
  std::vector<Before> changes;  // since the last Keep(), in order

  /// The value of `key`; null: there is none.
  toml::node* At(std::string_view key) {
    const std::vector<Step> steps = Steps(key);
    return steps.empty() ? nullptr : Find(root, steps);
  }

  /// Takes what stands where the steps lead. If nothing does, what is made there, or around it, is to go again.
  void Note(std::span<const Step> steps) {
    toml::node* node = Find(root, steps);
    std::size_t made = steps.size();  // the steps that lead to what is to go
    if (node == nullptr)
      for (made = 1; made < steps.size() && Find(root, steps.first(made)) != nullptr;) ++made;
    Before& before = changes.emplace_back();
    before.steps.assign(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(made));
    if (node != nullptr) before.node.push_back(std::move(*node));
  }
};

ValueTables::ValueTables(const Value::Table& values) : content_(new Content{ToTable(values), {}}) {}
ValueTables::ValueTables(const ValueTables& other) : content_(new Content{other.content_->root, {}}) {}
ValueTables& ValueTables::operator=(const ValueTables& other) {
  *this->content_ = Content{other.content_->root, {}};
  return *this;
}
ValueTables::~ValueTables() = default;

bool ValueTables::Has(std::string_view key) const { return content_->At(key) != nullptr; }

std::optional<Value> ValueTables::Get(std::string_view key) const {
  const toml::node* node = content_->At(key);
  return node != nullptr ? std::optional(ToValue(*node)) : std::nullopt;
}

void ValueTables::Set(std::string_view key, const Value& value, const std::string& where) {
  const std::vector<Step> steps = Steps(key);
  if (steps.empty()) throw ConfigError({where + ": " + ExpectedKey(key)});
  content_->Note(steps);
  toml::table alone = ToTable({{"value", value}});
  try {
    Put(content_->root, steps, std::move(*alone.get("value")), /*extends=*/true);
  } catch (const std::invalid_argument& why) {
    throw ConfigError({where + ": " + why.what()});
  }
}

void ValueTables::Erase(std::string_view key) {
  if (content_->At(key) == nullptr) return;
  const std::vector<Step> steps = Steps(key);
  content_->Note(steps);
  Remove(content_->root, steps);
}

void ValueTables::Undo() {
  for (auto& changes = content_->changes; !changes.empty(); changes.pop_back()) {
    Content::Before& before = changes.back();
    if (!before.node.empty())
      Put(content_->root, before.steps, std::move(*before.node.get(0)), /*extends=*/false);
    else
      Remove(content_->root, before.steps);
  }
}

void ValueTables::Keep() { content_->changes.clear(); }

Section ValueTables::Read(const std::string& where) const {
  auto document = std::make_shared<Section::Document>(where);
  document->is_recorded = false;
  Section section = Section::Of(document);
  section.table_->toml = &content_->root;
  return section;
}

}  // namespace mascot
