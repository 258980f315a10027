#include "orchestrator/report/figures.h"

#include <algorithm>
#include <cassert>

namespace mascot {
namespace {

constexpr std::string_view kAxisEndings[] = {".x", ".y", ".z"};

struct JsonOfValue {
  Json operator()(std::monostate) const { return nullptr; }
  Json operator()(const FigureValues& values) const {
    Json list = Json::array();
    for (const std::optional<double>& value : values) list.push_back(OrNull(value));
    return list;
  }
  Json operator()(const std::function<Json()>& make) const { return make(); }
  template <class Value>
  Json operator()(const Value& value) const {
    return value;
  }
};

bool IsOfVector(std::string_view name) {
  return name.ends_with(kAxisEndings[0]) || name.ends_with(kAxisEndings[1]) || name.ends_with(kAxisEndings[2]);
}

}  // namespace

void Figures::Add(std::string name, FigureValue value) {
  assert(!Has(name));
  all_.push_back({std::move(name), std::move(value)});
}

void Figures::AddVector(const std::string& name, const Eigen::Vector3d& value) {
  for (int axis = 0; axis < 3; ++axis) Add(name + std::string(kAxisEndings[axis]), value[axis]);
}

void Figures::AddVector(const std::string& name, const std::optional<Eigen::Vector3d>& value) {
  if (value)
    AddVector(name, *value);
  else
    Add(name, FigureValue());
}

void Figures::AddWords(std::string name, const std::string& words) {
  Add(std::move(name), words.empty() ? FigureValue() : FigureValue(words));
}

void Figures::Add(const Figures& part) {
  for (const Figure& figure : part.all()) Add(figure.name, figure.value);
}

bool Figures::Has(std::string_view name) const { return std::ranges::find(all_, name, &Figure::name) != all_.end(); }

const FigureValue& Figures::Find(std::string_view name) const {
  assert(Has(name));
  return std::ranges::find(all_, name, &Figure::name)->value;
}

std::optional<double> Figures::Number(std::string_view name) const {
  const FigureValue& value = Find(name);
  if (const auto* count = std::get_if<std::int64_t>(&value)) return static_cast<double>(*count);
  const auto* number = std::get_if<double>(&value);
  return number != nullptr ? std::optional(*number) : std::nullopt;
}

std::optional<Eigen::Vector3d> Figures::Vector(const std::string& name) const {
  if (Has(name)) return std::nullopt;  // it is without a value
  return Eigen::Vector3d(Known(name + ".x"), Known(name + ".y"), Known(name + ".z"));
}

std::string Figures::Words(std::string_view name) const {
  const auto* words = std::get_if<std::string>(&Find(name));
  return words != nullptr ? *words : "";
}

void AddTo(Json& object, const Figures& figures) {
  for (const Figure& figure : figures.all()) {
    std::string_view rest = figure.name;
    const bool is_of_vector = IsOfVector(rest);
    if (is_of_vector) rest.remove_suffix(2);
    Json* place = &object;
    for (auto dot = rest.find('.'); dot != rest.npos; dot = rest.find('.')) {
      place = &(*place)[std::string(rest.substr(0, dot))];
      rest.remove_prefix(dot + 1);
    }
    Json& value = (*place)[std::string(rest)];
    if (is_of_vector)
      value.push_back(std::visit(JsonOfValue(), figure.value));
    else
      value = std::visit(JsonOfValue(), figure.value);
  }
}

Json JsonOf(const Figures& figures) {
  Json object = Json::object();
  AddTo(object, figures);
  return object;
}

}  // namespace mascot
