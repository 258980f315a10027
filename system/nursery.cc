#include "system/nursery.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "system/descriptor.h"
#include "system/end_now.h"
#include "system/left_file.h"
#include "system/spawn.h"

namespace mascot {
namespace {

constexpr int kLook_ms = 1;  // from one look for the end of a process without a handle to the next

/// Reads words that end with a zero byte.
class OrderReader {
 public:
  explicit OrderReader(std::string text) : text_(std::move(text)) {}
  std::string Next() {
    const std::size_t end = text_.find('\0', at_);
    if (end == text_.npos) throw std::runtime_error("--nursery: an order that ends too early");
    std::string word = text_.substr(at_, end - at_);
    at_ = end + 1;
    return word;
  }
  int NextNumber() { return std::atoi(Next().c_str()); }

 private:
  std::string text_;
  std::size_t at_ = 0;
};

/// Writes the command line of a copy over that of the process that it was made from.
void TakeCommandLine(const std::vector<std::string>& words, int argc, char** argv) {
  char* const begin = argv[0];
  char* const end = argv[argc - 1] + std::strlen(argv[argc - 1]);
  std::string line;
  for (const std::string& word : words) line.append(word).push_back('\0');
  line.resize(static_cast<std::size_t>(end - begin), '\0');
  std::ranges::copy(line, begin);
}

/// Waits until `parent`, of which this process is a copy, has ended, and another process has adopted this one. The end
/// of a pipe would not do: descriptors are closed before that.
void AwaitAdoption(pid_t parent) {
  if (getppid() != parent) return;
  const Descriptor handle(static_cast<int>(syscall(SYS_pidfd_open, parent, 0)));
  pollfd end{handle.number(), POLLIN, 0};  // none, if `parent` has just ended: then this is ignored
  while (getppid() == parent && poll(&end, 1, kLook_ms) <= 0) {
  }
}

/// What a process that makes copies is told.
struct Order {
  int numbers = -1;  // descriptor for their process ids
  std::vector<Copy> copies;
};

Order ReadOrder() {
  OrderReader reader(ReadToEnd(STDIN_FILENO));
  Order order;
  order.numbers = reader.NextNumber();
  order.copies.resize(static_cast<std::size_t>(reader.NextNumber()));
  for (Copy& copy : order.copies) {
    copy.output = reader.NextNumber();
    copy.words.resize(static_cast<std::size_t>(reader.NextNumber()));
    for (std::string& word : copy.words) word = reader.Next();
  }
  return order;
}

/// In a copy of `parent` that was just made: leaves what belongs to that and to the other copies, and waits for the end
/// of `parent`.
void Settle(const Copy& copy, const Order& order, pid_t parent) {
  setpgid(0, 0);
  const Descriptor nothing(open("/dev/null", O_RDONLY | O_CLOEXEC));
  dup2(nothing.number(), STDIN_FILENO);
  dup2(copy.output, STDOUT_FILENO);
  dup2(copy.output, STDERR_FILENO);
  close(order.numbers);
  for (const Copy& any : order.copies) close(any.output);
  AwaitAdoption(parent);
}

}  // namespace

std::string NurseryOrder(const std::vector<Copy>& copies, int numbers) {
  std::string order;
  const auto add = [&order](const std::string& word) { order.append(word).push_back('\0'); };
  add(std::to_string(numbers));
  add(std::to_string(copies.size()));
  for (const Copy& copy : copies) {
    add(std::to_string(copy.output));
    add(std::to_string(copy.words.size()));
    for (const std::string& word : copy.words) add(word);
  }
  return order;
}

std::string NurseryRoom(const std::vector<Copy>& copies) {
  std::size_t longest = 0;
  for (const Copy& copy : copies) {
    std::size_t length = 0;
    for (const std::string& word : copy.words) length += word.size() + 1;
    longest = std::max(longest, length);
  }
  return std::string(longest, ' ');
}

std::vector<std::string> WordsOrCopies(int argc, char** argv) {
  if (argc < 3 || argv[1] != std::string_view(kNursery)) return {argv, argv + argc};
  const Order order = ReadOrder();
  const pid_t us = getpid();
  std::string numbers;
  for (const Copy& copy : order.copies) {
    const pid_t number = SplitProcess();
    if (number == 0) {
      TakeCommandLine(copy.words, argc, argv);
      Settle(copy, order, us);
      return copy.words;
    }
    numbers += std::to_string(number) + "\n";
  }
  EndNow(WriteAll(order.numbers, numbers) ? 0 : 1);
}

}  // namespace mascot
