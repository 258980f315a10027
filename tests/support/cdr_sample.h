#pragma once

// Samples of DDS, byte by byte.

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <string>
#include <vector>

namespace mascot::test {

/// A sample of CDR, little-endian: each field is aligned to its own size.
class Sample {
 public:
  template <class T>
  Sample& Add(T value) {
    while (body() % sizeof value != 0) bytes_.push_back(0);
    const std::size_t place = bytes_.size();
    bytes_.resize(place + sizeof value);
    std::memcpy(&bytes_[place], &value, sizeof value);
    return *this;
  }
  Sample& Text(const std::string& text) {
    Add(static_cast<std::uint32_t>(text.size() + 1));
    bytes_.insert(bytes_.end(), text.begin(), text.end());
    bytes_.push_back(0);
    return *this;
  }
  Sample& Header(const std::string& frame) { return Add(std::int32_t{5}).Add(std::uint32_t{6}).Text(frame); }
  Sample& Doubles(std::initializer_list<double> values) {
    for (const double value : values) Add(value);
    return *this;
  }
  const std::vector<std::uint8_t>& bytes() const { return bytes_; }
  std::size_t body() const { return bytes_.size() - 4; }

 private:
  std::vector<std::uint8_t> bytes_{0, 1, 0, 0};
};

/// Fails if a sample that is cut anywhere is read, or crashes.
template <class Read>
void ExpectNoneOfTheCut(const Sample& whole, const Read& read) {
  ASSERT_TRUE(read(whole.bytes()));
  for (std::size_t size = 0; size < whole.bytes().size(); ++size) {
    const std::vector<std::uint8_t> cut(whole.bytes().begin(), whole.bytes().begin() + static_cast<long>(size));
    EXPECT_FALSE(read(cut)) << size << " bytes";
  }
}

}  // namespace mascot::test
