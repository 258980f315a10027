// law_model.h as an FMU of FMI 2.
#include <cstdlib>
#include <cstring>
#include <new>

#include "tests/fmus/law_model.h"

using law_model::Model;

namespace {

struct Callbacks {
  void (*logger)(void* environment, const char* instance, int status, const char* category, const char* format, ...);
  void* (*allocate)(std::size_t count, std::size_t size);
  void (*free)(void* memory);
  void (*step_finished)(void* environment, int status);
  void* environment;
};
struct Component {
  Model model;
  const Callbacks* callbacks;
};

bool was_fatal = false;  // no function may be called any more

Model& In(void* component) { return static_cast<Component*>(component)->model; }

}  // namespace

#define EXPORT extern "C" __attribute__((visibility("default")))

EXPORT void* fmi2Instantiate(const char*, int, const char* guid, const char* resources, const Callbacks* callbacks, int,
                             int) {
  if (std::strcmp(guid, "{law}") != 0 || std::strncmp(resources, "file:///", 8) != 0) {
    callbacks->logger(callbacks->environment, "law", 3, "logError", "the guid %s is not %s", guid, "{law}");
    return nullptr;
  }
  void* const memory = callbacks->allocate(1, sizeof(Component));
  auto* const component = new (memory) Component{Model(), callbacks};
  component->model.resources = std::string(resources).substr(7) + "/";  // this path has no encoded characters
  return component;
}
EXPORT int fmi2SetDebugLogging(void* component, int on, std::size_t count, const char* const* categories) {
  In(component).logs_errors = on != 0 && count == 1 && std::strcmp(categories[0], "logStatusWarning") == 0;
  return 0;
}
EXPORT void fmi2FreeInstance(void* component) {
  if (was_fatal) std::abort();
  const Callbacks* const callbacks = static_cast<Component*>(component)->callbacks;
  static_cast<Component*>(component)->~Component();
  callbacks->free(component);
}
EXPORT int fmi2SetupExperiment(void*, int, double, double, int, double) { return 0; }
EXPORT int fmi2EnterInitializationMode(void*) { return 0; }
EXPORT int fmi2ExitInitializationMode(void*) { return 0; }
EXPORT int fmi2Terminate(void* component) {
  if (In(component).does == law_model::kError) std::abort();  // after an error, an instance may only be freed
  return 0;
}
EXPORT int fmi2SetReal(void* component, const unsigned* references, std::size_t count, const double* values) {
  for (std::size_t k = 0; k < count; ++k) {
    double* const place = In(component).Real(references[k]);
    if (place == nullptr || In(component).Refuses(references[k], values[k])) return 3;
    *place = values[k];
  }
  return 0;
}
EXPORT int fmi2SetInteger(void* component, const unsigned* references, std::size_t count, const int* values) {
  for (std::size_t k = 0; k < count; ++k) {
    int* const place = In(component).Integer(references[k]);
    if (place == nullptr) return 3;
    *place = values[k];
  }
  return 0;
}
EXPORT int fmi2SetString(void* component, const unsigned*, std::size_t, const char* const* values) {
  In(component).label = values[0];
  return In(component).label == "bad" ? 3 : 0;
}
EXPORT int fmi2GetReal(void* component, const unsigned* references, std::size_t count, double* values) {
  for (std::size_t k = 0; k < count; ++k) values[k] = *In(component).Real(references[k]);
  return 0;
}
EXPORT int fmi2DoStep(void* component, double t, double step, int) {
  const Callbacks& callbacks = *static_cast<Component*>(component)->callbacks;
  In(component).Step(t, step);
  switch (In(component).does) {
    case law_model::kError:
    case law_model::kFatal:
      callbacks.logger(callbacks.environment, "law", 3, "logError", "no more after %g s", t);
      was_fatal = In(component).does == law_model::kFatal;
      return was_fatal ? 4 : 3;
    case law_model::kWarn:
      if (In(component).logs_errors)
        callbacks.logger(callbacks.environment, "law", 1, "logStatusWarning", "%s at %g s", "too fast", t);
      return 1;
    case law_model::kDiscard:
      return 2;
    case law_model::kEnd:
      return 5;
    default:
      return 0;
  }
}
