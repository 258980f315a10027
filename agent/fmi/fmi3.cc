// Instances of FMI 3 for co-simulation. The declarations say what the standard does, in our words.
#include <cmath>
#include <filesystem>

#include "agent/fmi/calls.h"

namespace mascot {
namespace {

extern "C" {
using Fmi3Log = void (*)(void* environment, int status, const char* category, const char* message);
using Fmi3Update = void (*)(void* environment, double t, bool set_requested, bool get_allowed, bool step_finished,
                            bool may_return_early, bool* returns_early, double* return_time);
using Fmi3Instantiate = void* (*)(const char* name, const char* token, const char* resources, bool visible,
                                  bool logging, bool event_mode, bool early_return, const std::uint32_t* intermediate,
                                  std::size_t intermediates, void* environment, Fmi3Log log, Fmi3Update update);
using Fmi3Free = void (*)(void* instance);
using Fmi3Enter = int (*)(void* instance, bool has_tolerance, double tolerance, double start, bool has_stop,
                          double stop);
using Fmi3Plain = int (*)(void* instance);
using Fmi3SetString = int (*)(void* instance, const std::uint32_t* references, std::size_t count,
                              const char* const* values, std::size_t size);
using Fmi3DoStep = int (*)(void* instance, double t, double step, bool no_return_to_the_past, bool* event,
                           bool* terminate, bool* early, double* last_time);

void LogOfFmi3(void* environment, int status, const char* category, const char* message) {
  if (environment != nullptr) static_cast<FmuWords*>(environment)->Take(status, category, message);
}
}

template <class T>
using Fmi3Set = int (*)(void* instance, const std::uint32_t* references, std::size_t count, const T* values,
                        std::size_t size);
template <class T>
using Fmi3Get = int (*)(void* instance, const std::uint32_t* references, std::size_t count, T* values,
                        std::size_t size);

/// What functions call a numeric type.
std::string_view NameInFunctions(FmuType type) {
  constexpr std::string_view kNames[] = {"Float64", "Float32", "Int8",  "UInt8",  "Int16",  "UInt16",
                                         "Int32",   "UInt32",  "Int64", "UInt64", "Boolean"};
  return kNames[static_cast<std::size_t>(type)];
}

class Fmi3Instance final : public FmuInstance {
 public:
  Fmi3Instance(const FmuLibrary& library, const std::string& name, FmuLog log)
      : words_(library, std::move(log)),
        library_(library),
        free_(FmuFunction<Fmi3Free>(library, "fmi3FreeInstance")),
        enter_(FmuFunction<Fmi3Enter>(library, "fmi3EnterInitializationMode")),
        exit_(FmuFunction<Fmi3Plain>(library, "fmi3ExitInitializationMode")),
        terminate_(OptionalFmuFunction<Fmi3Plain>(library, "fmi3Terminate")),
        do_step_(FmuFunction<Fmi3DoStep>(library, "fmi3DoStep")) {
    const auto instantiate = FmuFunction<Fmi3Instantiate>(library, "fmi3InstantiateCoSimulation");
    for (std::size_t k = 0; k < std::size(set_); ++k) {
      const std::string type(NameInFunctions(static_cast<FmuType>(k)));
      set_[k] = OptionalFmuFunction<AnyFunction>(library, "fmi3Set" + type);
      get_[k] = OptionalFmuFunction<AnyFunction>(library, "fmi3Get" + type);
    }
    instance_ = instantiate(name.c_str(), library.model.token.c_str(), library.resources.c_str(), /*visible=*/false,
                            /*logging=*/false, /*event_mode=*/false, /*early_return=*/false, nullptr, 0, &words_,
                            LogOfFmi3, nullptr);
    if (instance_ == nullptr)
      words_.Fail("fmi3InstantiateCoSimulation", "no instance (instantiationToken " + library.model.token + ")");
    LogErrors<bool>(library, "fmi3SetDebugLogging", instance_);
  }
  ~Fmi3Instance() override {
    if (words_.is_dead()) return;
    if (has_started_ && !words_.has_failed() && terminate_ != nullptr) terminate_(instance_);
    free_(instance_);
  }
  Fmi3Instance(const Fmi3Instance&) = delete;
  Fmi3Instance& operator=(const Fmi3Instance&) = delete;

  void Begin(const FmuSettings& settings) override {
    if (!settings.structural.empty()) {
      words_.Require(FmuFunction<Fmi3Plain>(library_, "fmi3EnterConfigurationMode")(instance_),
                     "fmi3EnterConfigurationMode");
      for (FmuNumbers numbers : settings.structural) Set(numbers);
      words_.Require(FmuFunction<Fmi3Plain>(library_, "fmi3ExitConfigurationMode")(instance_),
                     "fmi3ExitConfigurationMode");
    }
    for (FmuNumbers numbers : settings.numbers) Set(numbers);
    for (const FmuTexts& texts : settings.texts) Set(texts);
    words_.Require(enter_(instance_, false, 0, 0, false, 0), "fmi3EnterInitializationMode");
  }
  void Start() override {
    words_.Require(exit_(instance_), "fmi3ExitInitializationMode");
    has_started_ = true;
  }
  void Set(FmuNumbers& numbers) override {
    VisitNumberType(numbers.type(), [&]<class T>(T) {
      const auto set = reinterpret_cast<Fmi3Set<T>>(Named(set_, "fmi3Set", numbers.type()));
      const auto values = numbers.As<T>();
      Require(set(instance_, numbers.references().data(), numbers.references().size(), values.data(), values.size()),
              "fmi3Set", numbers.type());
    });
  }
  void Set(const FmuTexts& texts) override {
    std::vector<const char*> values;
    for (const std::string& text : texts.texts) values.push_back(text.c_str());
    words_.Require(FmuFunction<Fmi3SetString>(library_, "fmi3SetString")(instance_, &texts.reference, 1, values.data(),
                                                                         values.size()),
                   "fmi3SetString");
  }
  void Get(FmuNumbers& numbers) override {
    VisitNumberType(numbers.type(), [&]<class T>(T) {
      const auto get = reinterpret_cast<Fmi3Get<T>>(Named(get_, "fmi3Get", numbers.type()));
      const auto room = numbers.Room<T>();
      Require(get(instance_, numbers.references().data(), numbers.references().size(), room.data(), room.size()),
              "fmi3Get", numbers.type());
      numbers.TakeRoom<T>();
    });
  }
  void Step(double t_s, double step_s) override {
    bool event = false, terminate = false, early = false;
    double last_s = t_s + step_s;
    words_.Require(
        do_step_(instance_, t_s, step_s, /*no_return_to_the_past=*/true, &event, &terminate, &early, &last_s),
        "fmi3DoStep");
    if (terminate) words_.Fail("fmi3DoStep", "it wants the simulation to end (terminateSimulation)");
    if (early)
      words_.Fail("fmi3DoStep",
                  fmt::format("it returned early, at its time {} s, which it was not allowed to", last_s));
  }

 private:
  using AnyFunction = void (*)();

  static AnyFunction Named(const AnyFunction (&functions)[11], const char* name, FmuType type) {
    const AnyFunction function = functions[static_cast<std::size_t>(type)];
    return function != nullptr ? function : Present(function, std::string(name) + std::string(NameInFunctions(type)));
  }
  void Require(int status, std::string_view function, FmuType type) {
    if (status == kFmuOk || status == kFmuWarning) return;
    words_.Require(status, std::string(function) + std::string(NameInFunctions(type)));
  }

  FmuWords words_;
  const FmuLibrary library_;
  void* instance_ = nullptr;
  bool has_started_ = false;
  AnyFunction set_[11] = {}, get_[11] = {};  // by FmuType
  Fmi3Free free_;
  Fmi3Enter enter_;
  Fmi3Plain exit_, terminate_;
  Fmi3DoStep do_step_;
};

}  // namespace

std::unique_ptr<FmuInstance> MakeFmi3Instance(const FmuLibrary& library, const std::string& name, FmuLog log) {
  return std::make_unique<Fmi3Instance>(library, name, std::move(log));
}

}  // namespace mascot
