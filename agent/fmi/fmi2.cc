// Instances of FMI 2 for co-simulation. The declarations say what the standard does, in our words.
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "agent/fmi/calls.h"

namespace mascot {
namespace {

extern "C" {
using Fmi2Logger = void (*)(void* environment, const char* instance, int status, const char* category,
                            const char* format, ...);
struct Fmi2Callbacks {
  Fmi2Logger logger;
  void* (*allocate)(std::size_t count, std::size_t size);
  void (*free)(void* memory);
  void (*step_finished)(void* environment, int status);
  void* environment;
};
using Fmi2Instantiate = void* (*)(const char* name, int kind, const char* guid, const char* resources,
                                  const Fmi2Callbacks* callbacks, int visible, int logging);
using Fmi2Free = void (*)(void* component);
using Fmi2Setup = int (*)(void* component, int has_tolerance, double tolerance, double start, int has_stop,
                          double stop);
using Fmi2Plain = int (*)(void* component);
using Fmi2SetReal = int (*)(void* component, const unsigned* references, std::size_t count, const double* values);
using Fmi2SetInteger = int (*)(void* component, const unsigned* references, std::size_t count, const int* values);
using Fmi2SetString = int (*)(void* component, const unsigned* references, std::size_t count,
                              const char* const* values);
using Fmi2GetReal = int (*)(void* component, const unsigned* references, std::size_t count, double* values);
using Fmi2GetInteger = int (*)(void* component, const unsigned* references, std::size_t count, int* values);
using Fmi2DoStep = int (*)(void* component, double t, double step, int no_return_to_the_past);

void LogOfFmi2(void* environment, const char* /*instance*/, int status, const char* category, const char* format, ...) {
  char text[1024] = "";
  std::va_list arguments;
  va_start(arguments, format);
  if (format != nullptr) std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  if (environment != nullptr) static_cast<FmuWords*>(environment)->Take(status, category, text);
}
}

constexpr int kCoSimulation = 1;

/// The folder as a URI: each byte that is no unreserved character of RFC 3986, and no slash, in hexadecimal.
std::string FileUri(const std::string& path) {
  std::string uri = "file://";
  for (const char c : path) {
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                          std::string_view("-._~/").find(c) != std::string_view::npos;
    uri += is_plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  if (uri.ends_with('/')) uri.pop_back();
  return uri;
}

class Fmi2Instance final : public FmuInstance {
 public:
  Fmi2Instance(const FmuLibrary& library, const std::string& name, FmuLog log)
      : words_(library, std::move(log)),
        callbacks_{LogOfFmi2, std::calloc, std::free, nullptr, &words_},
        free_(FmuFunction<Fmi2Free>(library, "fmi2FreeInstance")),
        setup_(FmuFunction<Fmi2Setup>(library, "fmi2SetupExperiment")),
        enter_(FmuFunction<Fmi2Plain>(library, "fmi2EnterInitializationMode")),
        exit_(FmuFunction<Fmi2Plain>(library, "fmi2ExitInitializationMode")),
        terminate_(OptionalFmuFunction<Fmi2Plain>(library, "fmi2Terminate")),
        set_real_(OptionalFmuFunction<Fmi2SetReal>(library, "fmi2SetReal")),
        set_integer_(OptionalFmuFunction<Fmi2SetInteger>(library, "fmi2SetInteger")),
        set_boolean_(OptionalFmuFunction<Fmi2SetInteger>(library, "fmi2SetBoolean")),
        set_string_(OptionalFmuFunction<Fmi2SetString>(library, "fmi2SetString")),
        get_real_(OptionalFmuFunction<Fmi2GetReal>(library, "fmi2GetReal")),
        get_integer_(OptionalFmuFunction<Fmi2GetInteger>(library, "fmi2GetInteger")),
        get_boolean_(OptionalFmuFunction<Fmi2GetInteger>(library, "fmi2GetBoolean")),
        do_step_(FmuFunction<Fmi2DoStep>(library, "fmi2DoStep")) {
    const auto instantiate = FmuFunction<Fmi2Instantiate>(library, "fmi2Instantiate");
    component_ = instantiate(name.c_str(), kCoSimulation, library.model.token.c_str(),
                             FileUri(library.resources).c_str(), &callbacks_, /*visible=*/0, /*logging=*/0);
    if (component_ == nullptr) words_.Fail("fmi2Instantiate", "no instance (guid " + library.model.token + ")");
    LogErrors<int>(library, "fmi2SetDebugLogging", component_);
  }
  ~Fmi2Instance() override {
    if (words_.is_dead()) return;
    if (has_started_ && !words_.has_failed() && terminate_ != nullptr) terminate_(component_);
    free_(component_);
  }
  Fmi2Instance(const Fmi2Instance&) = delete;
  Fmi2Instance& operator=(const Fmi2Instance&) = delete;

  void Begin(const FmuSettings& settings) override {
    Apply(settings);
    words_.Require(setup_(component_, 0, 0, 0, 0, 0), "fmi2SetupExperiment");
    words_.Require(enter_(component_), "fmi2EnterInitializationMode");
  }
  void Start() override {
    words_.Require(exit_(component_), "fmi2ExitInitializationMode");
    has_started_ = true;
  }
  void Set(FmuNumbers& numbers) override {
    const auto set = [&](auto function, auto values, std::string_view name) {
      const auto references = numbers.references();
      words_.Require(Present(function, name)(component_, references.data(), references.size(), values.data()), name);
    };
    if (numbers.type() == FmuType::kInt32) return set(set_integer_, numbers.As<int>(), "fmi2SetInteger");
    if (numbers.type() == FmuType::kFloat64) return set(set_real_, numbers.As<double>(), "fmi2SetReal");
    for (double& value : numbers.values()) value = value != 0 ? 1 : 0;
    set(set_boolean_, numbers.As<int>(), "fmi2SetBoolean");
  }
  void Set(const FmuTexts& texts) override {
    const char* const text = texts.texts.front().c_str();
    words_.Require(Present(set_string_, "fmi2SetString")(component_, &texts.reference, 1, &text), "fmi2SetString");
  }
  void Get(FmuNumbers& numbers) override {
    if (numbers.type() == FmuType::kInt32) return GetAs<int>(get_integer_, numbers, "fmi2GetInteger");
    if (numbers.type() == FmuType::kBoolean) return GetAs<int>(get_boolean_, numbers, "fmi2GetBoolean");
    GetAs<double>(get_real_, numbers, "fmi2GetReal");
  }
  void Step(double t_s, double step_s) override {
    const int status = do_step_(component_, t_s, step_s, /*no_return_to_the_past=*/1);
    if (status == kFmuPending)
      words_.Fail("fmi2DoStep", "pending: the step would end later, which a law with a control period cannot do");
    if (status == kFmuDiscard) words_.Fail("fmi2DoStep", "discard: the step ended before the control period did");
    words_.Require(status, "fmi2DoStep");
  }

 private:
  template <class T, class Function>
  void GetAs(Function get, FmuNumbers& numbers, std::string_view name) {
    const auto references = numbers.references();
    words_.Require(Present(get, name)(component_, references.data(), references.size(), numbers.Room<T>().data()),
                   name);
    numbers.TakeRoom<T>();
  }
  void Apply(const FmuSettings& settings) {
    for (FmuNumbers numbers : settings.numbers) Set(numbers);
    for (const FmuTexts& texts : settings.texts) Set(texts);
  }

  FmuWords words_;
  const Fmi2Callbacks callbacks_;  // the FMU keeps its address
  void* component_ = nullptr;
  bool has_started_ = false;
  Fmi2Free free_;
  Fmi2Setup setup_;
  Fmi2Plain enter_, exit_, terminate_;
  Fmi2SetReal set_real_;
  Fmi2SetInteger set_integer_, set_boolean_;
  Fmi2SetString set_string_;
  Fmi2GetReal get_real_;
  Fmi2GetInteger get_integer_, get_boolean_;
  Fmi2DoStep do_step_;
};

}  // namespace

std::unique_ptr<FmuInstance> MakeFmi2Instance(const FmuLibrary& library, const std::string& name, FmuLog log) {
  return std::make_unique<Fmi2Instance>(library, name, std::move(log));
}

}  // namespace mascot
