// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <csignal>

namespace multicam_egomotion {

/// SIGINT and SIGTERM only ask the program to end from here on; it says when. For executables.
class StopSignals {
 public:
  /// `on_signal` (may be null) runs in the signal handler.
  static void watch(void (*on_signal)() = nullptr) {
    on_signal_ = on_signal;
    std::signal(SIGINT, &StopSignals::handle);
    std::signal(SIGTERM, &StopSignals::handle);
  }
  static bool received() { return received_ != 0; }

 private:
  static void handle(int) {
    received_ = 1;
    if (on_signal_ != nullptr) on_signal_();
  }

  static inline volatile std::sig_atomic_t received_ = 0;
  static inline void (*on_signal_)() = nullptr;
};

}  // namespace multicam_egomotion
