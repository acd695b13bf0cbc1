// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// The solvers' inner code (*.inc) is compiled for the instruction set of the build and, where the compiler can choose
// at run time, for AVX2 with FMA as well.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !(defined(__AVX2__) && defined(__FMA__))
#define MULTICAM_EGOMOTION_DISPATCH_AVX2 1
#else
#define MULTICAM_EGOMOTION_DISPATCH_AVX2 0
#endif

namespace multicam_egomotion {

#if MULTICAM_EGOMOTION_DISPATCH_AVX2
inline bool processorHasAvx2() {
  static const bool has = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  return has;
}
#endif

}  // namespace multicam_egomotion
