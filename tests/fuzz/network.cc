// Fuzzer: any bytes as a network of the format ONNX. They are refused in words, or answer with numbers, the same ones
// each time.
#include "agent/network/network.h"

#include <cstring>
#include <string_view>
#include <vector>

#include "tests/fuzz/fuzz.h"

namespace mascot {
namespace {

void Answer(const Network& network) {
  std::vector<double> input(network.inputs());
  for (std::size_t k = 0; k < input.size(); ++k) input[k] = static_cast<double>(k % 7) - 3;
  Network::Scratch scratch = network.MakeScratch(), other = network.MakeScratch();
  const auto once = network.Answer(input, scratch), again = network.Answer(input, other);
  Require(once.size() == network.outputs() && once.size() == again.size(), "an answer of another length");
  Require(std::memcmp(once.data(), again.data(), once.size() * sizeof(double)) == 0, "another answer");
}

}  // namespace
}  // namespace mascot

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    mascot::Answer(mascot::Network::FromOnnx({reinterpret_cast<const char*>(data), size}));
  } catch (const mascot::NetworkError& error) {
    mascot::Require(!std::string_view(error.what()).empty(), "an error without words");
  }
  return 0;
}
