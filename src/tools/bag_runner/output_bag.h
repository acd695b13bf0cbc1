// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rosbag/bag.h>

#include <functional>
#include <memory>
#include <string>

namespace multicam_egomotion {

/// A bag that is written. What fails throws std::runtime_error (file, reason), once: rosbag's own destructor would
/// write again and end the program.
class OutputBag {
 public:
  explicit OutputBag(const std::string& path);
  ~OutputBag();
  OutputBag(const OutputBag&) = delete;
  OutputBag& operator=(const OutputBag&) = delete;

  void write(const std::function<void(rosbag::Bag&)>& write_to);
  void close();

 private:
  const std::string path_;
  std::unique_ptr<rosbag::Bag> bag_;
};

}  // namespace multicam_egomotion
