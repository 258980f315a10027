// Preloaded into the processes of a run (LD_PRELOAD). Counts the malloc calls of each executable and library, and
// writes the counts to MASCOT_ALLOCATIONS/<program>.<pid> when the process ends, in lines "count object". If there is a
// file MASCOT_ALLOCATIONS/window, only those count that are made while its first byte is 1.
#include <dlfcn.h>
#include <execinfo.h>
#include <fcntl.h>
#include <link.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>

extern "C" {
void* __libc_malloc(std::size_t bytes);
void* __libc_calloc(std::size_t count, std::size_t bytes);
void* __libc_realloc(void* old, std::size_t bytes);
void* __libc_memalign(std::size_t alignment, std::size_t bytes);
}

namespace {

/// An executable or library and its allocations.
struct Object {
  std::atomic<const link_map*> loaded = nullptr;
  std::atomic<long> allocations = 0;
};

std::array<Object, 64> objects;
std::atomic<bool> counting = false;
const volatile char always = '1';
const volatile char* window = &always;                                        // what another process writes
thread_local bool inside __attribute__((tls_model("initial-exec"))) = false;  // in Count(): the unwinder allocates too

/// The executable or library that contains the code at this address; nullptr: none.
const link_map* ObjectOf(void* code) {
  dl_find_object found;
  return ::_dl_find_object(code, &found) == 0 ? found.dlfo_link_map : nullptr;
}

const char* PathOf(const link_map& object) { return *object.l_name == 0 ? program_invocation_name : object.l_name; }

/// Whether the object only allocates on behalf of its callers (libc, libstdc++, this library).
bool IsGoBetween(const link_map* object) {
  static const link_map* const own = ObjectOf(reinterpret_cast<void*>(&IsGoBetween));
  return object == nullptr || object == own || std::strstr(object->l_name, "/libc.so") != nullptr ||
         std::strstr(object->l_name, "/libstdc++.so") != nullptr;
}

void CountFor(const link_map* loaded) {
  for (Object& object : objects) {
    const link_map* nobody = nullptr;
    object.loaded.compare_exchange_strong(nobody, loaded);
    if (object.loaded != loaded) continue;
    ++object.allocations;
    return;
  }
}

/// `caller`: the return address of the function that allocates.
void Count(void* caller) {
  if (!counting || inside || *window != '1') return;
  inside = true;
  const link_map* object = ObjectOf(caller);
  if (IsGoBetween(object)) {
    std::array<void*, 32> frames;
    const int depth = ::backtrace(frames.data(), static_cast<int>(frames.size()));
    for (int k = 0; k < depth && IsGoBetween(object); ++k) object = ObjectOf(frames[static_cast<std::size_t>(k)]);
  }
  if (object != nullptr) CountFor(object);
  inside = false;
}

__attribute__((constructor)) void Begin() {
  std::array<void*, 1> frame;
  ::backtrace(frame.data(), 1);  // loads the unwinder
  if (const char* folder = std::getenv("MASCOT_ALLOCATIONS")) {
    char path[512];
    std::snprintf(path, sizeof path, "%s/window", folder);
    const int file = ::open(path, O_RDONLY | O_CLOEXEC);
    void* place = file < 0 ? MAP_FAILED : ::mmap(nullptr, 1, PROT_READ, MAP_SHARED, file, 0);
    if (place != MAP_FAILED) window = static_cast<const volatile char*>(place);
    if (file >= 0) ::close(file);
  }
  counting = true;
}

__attribute__((destructor)) void Write() {
  counting = false;
  const char* folder = std::getenv("MASCOT_ALLOCATIONS");
  if (folder == nullptr) return;
  char path[512];
  std::snprintf(path, sizeof path, "%s/%s.%d", folder, program_invocation_short_name, ::getpid());
  std::FILE* file = std::fopen(path, "w");
  if (file == nullptr) return;
  for (const Object& object : objects)
    if (object.allocations > 0) std::fprintf(file, "%ld %s\n", object.allocations.load(), PathOf(*object.loaded));
  std::fclose(file);
}

}  // namespace

extern "C" {
void* malloc(std::size_t bytes) {
  Count(__builtin_return_address(0));
  return __libc_malloc(bytes);
}
void* calloc(std::size_t count, std::size_t bytes) {
  Count(__builtin_return_address(0));
  return __libc_calloc(count, bytes);
}
void* realloc(void* old, std::size_t bytes) {
  Count(__builtin_return_address(0));
  return __libc_realloc(old, bytes);
}
void* memalign(std::size_t alignment, std::size_t bytes) {
  Count(__builtin_return_address(0));
  return __libc_memalign(alignment, bytes);
}
void* aligned_alloc(std::size_t alignment, std::size_t bytes) {
  Count(__builtin_return_address(0));
  return __libc_memalign(alignment, bytes);
}
int posix_memalign(void** place, std::size_t alignment, std::size_t bytes) {
  Count(__builtin_return_address(0));
  *place = __libc_memalign(alignment, bytes);
  return *place == nullptr ? ENOMEM : 0;
}
}

// With the operators of the C++ library, malloc would see libstdc++ as its caller.
void* operator new(std::size_t bytes) {
  Count(__builtin_return_address(0));
  if (void* place = __libc_malloc(bytes)) return place;
  throw std::bad_alloc();
}
void* operator new[](std::size_t bytes) {
  Count(__builtin_return_address(0));
  if (void* place = __libc_malloc(bytes)) return place;
  throw std::bad_alloc();
}
