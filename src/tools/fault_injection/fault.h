// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>

#include "fault_injection/fault_values.h"
#include "fault_injection/recorded_message.h"

namespace multicam_egomotion {

using Emit = std::function<void(RecordedMessage)>;

/// A fault at work: takes the messages of a bag one by one, in the order of arrival, and hands on none, one or several
/// for each. Whatever it remembers between them is its own.
using Fault = std::function<void(RecordedMessage message, const Emit& emit)>;

/// What a fault is made from.
struct FaultSetting {
  FaultValues values;
  BagLayout layout;
  std::uint64_t seed = 1;

  /// The message was recorded within `from` and `to` of the values [s since the bag's begin].
  bool active(const RecordedMessage& message) const;
  double since(const RecordedMessage& message, const char* parameter) const;  ///< seconds after that parameter's moment
  /// An image of the chosen camera (all with -1) while active.
  bool activeImage(const RecordedMessage& message) const;
  /// The same of a CameraInfo.
  bool activeCameraInfo(const RecordedMessage& message) const;
  bool activeImu(const RecordedMessage& message) const { return isImu(message) && active(message); }
};

/// Every n-th call is true, the first one among them.
class EveryNth {
 public:
  explicit EveryNth(int n) : n_(n) {}
  bool operator()() { return count_++ % n_ == 0; }

 private:
  int n_;
  int count_ = 0;
};

}  // namespace multicam_egomotion
