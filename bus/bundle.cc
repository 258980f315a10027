#include "bus/bundle.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string>

namespace mascot {

void BundleWriter::Begin(std::int64_t tick) {
  bytes_.assign(kEncapsulation.begin(), kEncapsulation.end());
  std::memcpy(Grow(sizeof tick), &tick, sizeof tick);
}

void BundleWriter::BeginSection(std::uint32_t number) {
  const std::uint32_t head[] = {number, 0};
  count_ = bytes_.size() + sizeof number;
  std::memcpy(Grow(sizeof head), head, sizeof head);
}

std::uint8_t* BundleWriter::Grow(std::size_t bytes) {
  bytes_.resize(bytes_.size() + bytes);
  return bytes_.data() + bytes_.size() - bytes;
}

void BundleWriter::Count(std::uint32_t more) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes_.data() + count_, sizeof count);
  count += more;
  std::memcpy(bytes_.data() + count_, &count, sizeof count);
}

std::uint8_t* BundleWriter::Add(std::size_t body) {
  Count(1);
  return Grow(body);
}

void BundleWriter::Add(std::span<const std::uint8_t> body) { std::ranges::copy(body, Add(body.size())); }

void BundleWriter::Add(const SampleBodies& bodies) {
  Count(bodies.count);
  bytes_.insert(bytes_.end(), bodies.bytes.begin(), bodies.bytes.end());
}

BundleReader::BundleReader(std::span<const std::uint8_t> bytes) : whole_(bytes.size()), rest_(bytes) {
  if (!std::ranges::equal(Take(kEncapsulation.size()), kEncapsulation))
    throw std::runtime_error("a sample that is no CDR of this kind");
  std::memcpy(&tick_, Take(sizeof tick_).data(), sizeof tick_);
}

std::span<const std::uint8_t> BundleReader::Take(std::size_t bytes) {
  if (bytes > rest_.size()) throw std::runtime_error("a sample of only " + std::to_string(whole_) + " bytes");
  const auto taken = rest_.first(bytes);
  rest_ = rest_.subspan(bytes);
  return taken;
}

std::uint32_t BundleReader::TakeNumber() {
  std::uint32_t number = 0;
  std::memcpy(&number, Take(sizeof number).data(), sizeof number);
  return number;
}

BundleReader::Section BundleReader::Next(std::size_t body) {
  Section section{.number = TakeNumber(), .count = TakeNumber(), .body = body};
  section.first = Take(std::min(section.count, rest_.size()) * body).data();
  return section;
}

std::span<const std::span<const std::uint8_t>> BundleReader::NextMessages() {
  messages_.clear();
  TakeNumber();
  for (std::uint32_t left = TakeNumber(); left > 0; --left) {
    const std::uint8_t* const body = rest_.data();
    const std::size_t head = MessageBody(0);
    const std::size_t numbers = HeadOf(Take(head).data()).more;
    if (numbers > kMaxNumbers) throw std::runtime_error("a message of " + std::to_string(numbers) + " numbers");
    messages_.emplace_back(body, head + Take(sizeof(double) * numbers).size());
  }
  return messages_;
}

void BundleReader::End() const {
  if (!rest_.empty()) throw std::runtime_error("a sample with " + std::to_string(rest_.size()) + " bytes too many");
}

}  // namespace mascot
