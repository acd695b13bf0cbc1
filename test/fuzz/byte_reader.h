// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace multicam_egomotion {

/// Takes values off the front of a fuzzer's input; zeros once it is used up.
class ByteReader {
 public:
  ByteReader(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}

  std::size_t left() const { return size_; }

  template <class Value>
  Value take() {
    Value value{};
    const std::size_t count = std::min(sizeof(Value), size_);
    std::memcpy(&value, data_, count);
    data_ += count;
    size_ -= count;
    return value;
  }

  /// One of `count` choices.
  int choice(int count) { return take<std::uint8_t>() % count; }

  std::vector<std::uint8_t> bytes(std::size_t count) {
    count = std::min(count, size_);
    const std::vector<std::uint8_t> taken(data_, data_ + count);
    data_ += count;
    size_ -= count;
    return taken;
  }

 private:
  const std::uint8_t* data_;
  std::size_t size_;
};

}  // namespace multicam_egomotion
