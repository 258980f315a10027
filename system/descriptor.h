#pragma once

#include <string>
#include <utility>

namespace mascot {

/// Owns a file descriptor, or none (-1).
class Descriptor {
 public:
  explicit Descriptor(int number = -1) : number_(number) {}
  ~Descriptor();
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }

  int number() const { return number_; }
  bool is_open() const { return number_ >= 0; }

 private:
  int number_;
};

/// Reads until there is nothing more to come. Throws std::system_error.
std::string ReadToEnd(int descriptor);

/// The two ends of a pipe. Children do not inherit them, but for what Program gives them.
struct Pipe {
  Descriptor reads, writes;
};
/// Throws std::system_error: "cannot make a pipe: Too many open files".
Pipe MakePipe();

}  // namespace mascot
