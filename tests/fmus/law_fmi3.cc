// law_model.h as an FMU of FMI 3, in which p, v, u and the positions of neighbours are arrays.
#include <cstdint>
#include <cstdlib>
#include <cstring>

#include "tests/fmus/law_model.h"

using law_model::Model;

namespace {

using Log = void (*)(void* environment, int status, const char* category, const char* message);
struct Instance {
  Model model;
  void* environment;
  Log log;
};

bool was_fatal = false;  // no function may be called any more

Model& In(void* instance) { return static_cast<Instance*>(instance)->model; }

/// How many values a variable has.
std::size_t SizeOf(std::uint32_t reference) {
  using namespace law_model;
  if (reference == kMatrix) return 6;
  return reference == kP || reference == kV || reference == kU || reference == kNeighbours ||
                 reference == kNeighbours + kOfNeighbour
             ? 3
             : 1;
}

}  // namespace

#define EXPORT extern "C" __attribute__((visibility("default")))

EXPORT void* fmi3InstantiateCoSimulation(const char*, const char* token, const char* resources, bool, bool, bool events,
                                         bool early, const std::uint32_t*, std::size_t, void* environment, Log log,
                                         void*) {
  if (std::strcmp(token, "{law}") != 0 || resources[std::strlen(resources) - 1] != '/' || events || early) {
    log(environment, 3, "logError", "the token is not {law}");
    return nullptr;
  }
  auto* const instance = new Instance{Model(), environment, log};
  instance->model.resources = resources;
  return instance;
}
EXPORT int fmi3SetDebugLogging(void* instance, bool on, std::size_t count, const char* const* categories) {
  In(instance).logs_errors = on && count == 1 && std::strcmp(categories[0], "logStatusWarning") == 0;
  return 0;
}
EXPORT void fmi3FreeInstance(void* instance) {
  if (was_fatal) std::abort();
  delete static_cast<Instance*>(instance);
}
EXPORT int fmi3EnterInitializationMode(void*, bool, double, double, bool, double) { return 0; }
EXPORT int fmi3ExitInitializationMode(void*) { return 0; }
EXPORT int fmi3Terminate(void* instance) {
  if (In(instance).does == law_model::kError) std::abort();  // after an error, an instance may only be freed
  return 0;
}
EXPORT int fmi3SetFloat64(void* instance, const std::uint32_t* references, std::size_t count, const double* values,
                          std::size_t size) {
  for (std::size_t k = 0; k < count; ++k)
    for (std::size_t element = 0; element < SizeOf(references[k]); ++element, --size) {
      double* const place = In(instance).Real(references[k]);
      if (place == nullptr || size == 0 || In(instance).Refuses(references[k], *values)) return 3;
      place[element] = *values++;
    }
  return size == 0 ? 0 : 3;
}
EXPORT int fmi3SetInt32(void* instance, const std::uint32_t* references, std::size_t count, const std::int32_t* values,
                        std::size_t) {
  for (std::size_t k = 0; k < count; ++k) {
    int* const place = In(instance).Integer(references[k]);
    if (place == nullptr) return 3;
    *place = values[k];
  }
  return 0;
}
EXPORT int fmi3SetString(void* instance, const std::uint32_t*, std::size_t, const char* const* values, std::size_t) {
  In(instance).label = values[0];
  return In(instance).label == "bad" ? 3 : 0;
}
EXPORT int fmi3GetFloat64(void* instance, const std::uint32_t* references, std::size_t count, double* values,
                          std::size_t) {
  for (std::size_t k = 0; k < count; ++k)
    for (std::size_t element = 0; element < SizeOf(references[k]); ++element)
      *values++ = In(instance).Real(references[k])[element];
  return 0;
}
EXPORT int fmi3DoStep(void* instance, double t, double step, bool, bool* event, bool* terminate, bool* early,
                      double* last) {
  const Instance& one = *static_cast<Instance*>(instance);
  In(instance).Step(t, step);
  *event = *early = *terminate = false;
  *last = t + step;
  switch (one.model.does) {
    case law_model::kError:
    case law_model::kFatal:
      one.log(one.environment, 3, "logError", "no more");
      was_fatal = one.model.does == law_model::kFatal;
      return was_fatal ? 4 : 3;
    case law_model::kWarn:
      if (one.model.logs_errors) one.log(one.environment, 1, "logStatusWarning", "too fast");
      return 1;
    case law_model::kDiscard:
      return 2;
    case law_model::kEnd:
      *terminate = true;
      return 0;
    case law_model::kLose:
      *early = true;
      *last = t;
      return 0;
    default:
      return 0;
  }
}
