// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bag_runner/output_bag.h"

#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace multicam_egomotion {

OutputBag::OutputBag(const std::string& path) : path_(path), bag_(std::make_unique<rosbag::Bag>()) {
  write([this](rosbag::Bag& bag) { bag.open(path_, rosbag::bagmode::Write); });
}

OutputBag::~OutputBag() {
  try {
    close();
  } catch (const std::runtime_error&) {
    // Another output failed before; that is what the caller hears of.
  }
}

void OutputBag::write(const std::function<void(rosbag::Bag&)>& write_to) {
  errno = 0;
  try {
    write_to(*bag_);
  } catch (const rosbag::BagException& error) {
    const std::string reason = errno != 0 ? std::string(std::strerror(errno)) : std::string(error.what());
    static_cast<void>(bag_.release());  // never destroyed
    throw std::runtime_error("'" + path_ + "': not everything could be written: " + reason);
  }
}

void OutputBag::close() {
  if (bag_ == nullptr) return;
  write([](rosbag::Bag& bag) { bag.close(); });
  bag_.reset();
}

}  // namespace multicam_egomotion
