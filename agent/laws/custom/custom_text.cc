// What the text of a law in Python must be: it runs, and defines functions that can be called.
#include "agent/laws/custom/custom.h"
#include "agent/laws/parts/user_params.h"
#include "agent/user_code/law_output.h"

namespace mascot {
namespace {

/// A function that the text may define.
struct Callback {
  const char* name;
  const char* arguments;
  std::size_t count;
  bool required;
};

constexpr Callback kStandardCallbacks[] = {{"control", "(t, me, neighbours)", 3, true},
                                           {"start", "(me, params)", 2, false},
                                           {"set", "(me, params)", 2, false},
                                           {"message", "(me)", 1, false}};
constexpr Callback kPublishedCallbacks[] = {
    {"control_user", "(pos_x, vel_x, acc_x, pos_y, vel_y, acc_y, i, num_agent, leader)", 9, true}};

std::span<const Callback> CallbacksOf(PythonStyle style) {
  if (style == PythonStyle::kMascot) return kPublishedCallbacks;
  return kStandardCallbacks;
}

/// Notes a mistake if the function is required and missing, or cannot be called with its arguments.
void CheckCallback(Section& law, const CustomParams& params, const PythonModule& module, const Callback& callback) {
  const py::object function = module.Function(callback.name);
  const auto fail = [&](int line, const std::string& message) {
    law.FailInText(TextKey(law, kPythonKey), params.file + ":" + std::to_string(line) + ":1", message);
  };
  if (function.is_none()) {
    if (callback.required) fail(params.line, std::string("expected a function ") + callback.name + ", got none");
    return;
  }
  const std::string other = SignatureIfNotCallable(function, callback.count);
  if (!other.empty())
    fail(std::max(LineOf(function), 1),
         std::string("expected ") + callback.name + callback.arguments + ", got " + callback.name + other);
}

/// What a parameter is whose default is `value`, for messages; empty: it may be anything.
std::string KindOf(const py::handle& value) {
  if (py::isinstance<py::bool_>(value)) return "true or false";
  if (py::isinstance<py::int_>(value) || py::isinstance<py::float_>(value)) return "a number";
  if (py::isinstance<py::str>(value)) return "a string";
  if (py::isinstance<py::list>(value) || py::isinstance<py::tuple>(value)) return "a list";
  if (py::isinstance<py::dict>(value)) return "a table";
  return "";
}

/// Notes parameters that PARAMETERS does not have, and those that are something else than there.
void CheckParameters(Section& law, const CustomParams& params, const PythonModule& module) {
  const py::object declared = module.Parameters();
  if (declared.is_none()) return;
  if (!py::isinstance<py::dict>(declared))
    return law.FailInText(TextKey(law, kPythonKey), params.file + ":" + std::to_string(params.line) + ":1",
                          "expected PARAMETERS to be a dict, got " + Repr(declared));
  std::vector<std::string> names;
  for (const auto& [name, value] : declared.cast<py::dict>()) names.push_back(TextOf(py::str(name)));
  FailUnknownParams(law, params.params, std::vector<std::string_view>(names.begin(), names.end()));
  for (const auto& [name, value] : std::get<Value::Table>(params.params.data)) {
    if (!declared.contains(name)) continue;
    const std::string expected = KindOf(declared[py::str(name)]);
    if (!expected.empty() && KindOf(ToPython(value)) != expected)
      law.FailInside("params", name, "expected " + expected + " as in PARAMETERS, got " + ToToml(value));
  }
}

/// Not at the expense of the law, which has the time of a call for its own imports.
void LoadNumPy() {
  try {
    py::module_::import("numpy");
  } catch (const py::error_already_set&) {  // making the law will say that it is missing
  }
}

}  // namespace

bool TryText(Section& law, CustomParams& params, const LawLimits& limits) {
  const SuppressedLawOutput suppressed;
  const PythonLock lock;
  const std::string key = TextKey(law, kPythonKey);
  const std::string who = "the law in " + params.file;
  LoadNumPy();
  try {
    const LimitedPython limited(limits, who);
    const PythonModule module(params);
    for (const Callback& callback : CallbacksOf(params.style)) CheckCallback(law, params, module, callback);
    CheckParameters(law, params, module);
    if (module.Function("set").is_none()) params.fixed = "expected a law that defines set(me, params), got none";
    return params.style == PythonStyle::kStandard && !module.Function("message").is_none();
  } catch (const PythonError& error) {
    law.FailInText(key,
                   params.file + ":" + std::to_string(std::max(error.line(), 1)) + ":" +
                       std::to_string(std::max(error.column(), 1)),
                   "expected Python, got " + error.summary());
    return false;
  }
}

// Only me.rng, or me.random, knows run.seed, and control_user(...) is given no `me`.
bool CanDraw(const CustomParams& params) {
  const auto names_it = [](const std::string& text) {
    return text.find("random") != std::string::npos || text.find("rng") != std::string::npos;
  };
  const auto& modules = params.modules;
  return params.style == PythonStyle::kStandard &&
         (names_it(params.text) ||
          std::any_of(modules.begin(), modules.end(), [&](const auto& module) { return names_it(module.second); }));
}

}  // namespace mascot
