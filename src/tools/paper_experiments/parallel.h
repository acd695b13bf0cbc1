// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "bag_runner/progress_bar.h"

namespace multicam_egomotion {

/// Calls work(0) ... work(count - 1), each once, on `threads` threads, behind a progress bar with a title. What a call
/// writes must depend on its number alone. The first exception is passed on.
inline void forEachInParallel(const std::string& title, std::size_t count, int threads,
                              const std::function<void(std::size_t)>& work) {
  std::fprintf(stderr, "%s\n", title.c_str());
  ProgressBar bar(count);
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  std::exception_ptr failure;
  const auto run = [&] {
    for (std::size_t i = next++; i < count; i = next++) {
      try {
        work(i);
      } catch (...) {
        const std::lock_guard<std::mutex> lock(mutex);
        if (!failure) failure = std::current_exception();
        next = count;
        return;
      }
      const std::lock_guard<std::mutex> lock(mutex);
      bar.advance();
    }
  };
  std::vector<std::thread> others;
  for (int i = 1; i < threads; ++i) others.emplace_back(run);
  run();
  for (std::thread& thread : others) thread.join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace multicam_egomotion
