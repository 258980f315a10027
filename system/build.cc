#include "system/build.h"

#include <elf.h>
#include <fmt/format.h>
#include <link.h>

#include <cstring>

namespace mascot {
namespace {

/// The note of kind NT_GNU_BUILD_ID among `size` bytes of notes, in hexadecimal digits; empty: it is not there.
std::string BuildIdIn(const char* notes, std::size_t size) {
  const auto padded = [](std::size_t bytes) { return (bytes + 3) / 4 * 4; };
  while (size >= sizeof(ElfW(Nhdr))) {
    ElfW(Nhdr) note;
    std::memcpy(&note, notes, sizeof note);
    const std::size_t whole = sizeof note + padded(note.n_namesz) + padded(note.n_descsz);
    if (whole > size) break;
    if (note.n_type == NT_GNU_BUILD_ID && note.n_namesz == 4 && std::memcmp(notes + sizeof note, "GNU", 4) == 0) {
      std::string digits;
      for (std::size_t k = 0; k < note.n_descsz; ++k)
        digits += fmt::format("{:02x}", static_cast<unsigned char>(notes[sizeof note + padded(note.n_namesz) + k]));
      return digits;
    }
    notes += whole;
    size -= whole;
  }
  return "";
}

/// Looks at one loaded object, the program first. Returns 1: enough.
int LookAtProgram(dl_phdr_info* object, std::size_t /*size*/, void* id) {
  for (int k = 0; k < object->dlpi_phnum; ++k) {
    const ElfW(Phdr)& segment = object->dlpi_phdr[k];
    if (segment.p_type != PT_NOTE) continue;
    // NOLINTNEXTLINE(performance-no-int-to-ptr): the loader tells addresses as numbers
    const auto* const notes = reinterpret_cast<const char*>(object->dlpi_addr + segment.p_vaddr);
    const std::string digits = BuildIdIn(notes, segment.p_memsz);
    if (!digits.empty()) *static_cast<std::string*>(id) = digits;
  }
  return 1;
}

}  // namespace

std::string BuildText() {
  std::string id;
  dl_iterate_phdr(LookAtProgram, &id);
  return fmt::format("{}, build {}", MASCOT_VERSION, id.empty() ? "without identity" : id);
}

}  // namespace mascot
