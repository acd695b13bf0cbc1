// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/tracking/patch_alignment.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <opencv2/core/hal/intrin.hpp>

namespace multicam_egomotion {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;

// Grey-level noise and expected change of the linear part, for the prior that keeps weakly textured patches stiff.
constexpr double kIntensityNoise = 4.0;
constexpr double kLinearSigma = 0.05;
constexpr double kLinearPrecision = kIntensityNoise * kIntensityNoise / (kLinearSigma * kLinearSigma);
// Least curvature of the intensity along any shift, grey^2 per pixel of the patch.
constexpr double kMinCurvature = 4.0;

// Bilinear interpolation at four places inside the image.
cv::v_float32x4 bilinear(const std::uint8_t* data, std::ptrdiff_t step, const cv::v_float32x4& u,
                         const cv::v_float32x4& v) {
  // Rounding may carry the outermost sample just below zero.
  const cv::v_int32x4 zero = cv::v_setzero_s32();
  const cv::v_int32x4 iu = cv::v_max(cv::v_trunc(u), zero), iv = cv::v_max(cv::v_trunc(v), zero);
  int column[4], row[4];
  cv::v_store(column, iu);
  cv::v_store(row, iv);
  // A pixel and its right neighbour, those of the row below in the upper half of the word: little-endian.
  const auto word = [&](int i) {
    const std::uint8_t* p = data + row[i] * step + column[i];
    std::uint16_t above, below;
    std::memcpy(&above, p, 2);
    std::memcpy(&below, p + step, 2);
    return above | static_cast<std::uint32_t>(below) << 16;
  };
  const cv::v_uint32x4 four(word(0), word(1), word(2), word(3)), byte = cv::v_setall_u32(255);
  const auto grey = [](const cv::v_uint32x4& pixel) { return cv::v_cvt_f32(cv::v_reinterpret_as_s32(pixel)); };
  const cv::v_float32x4 left0 = grey(four & byte), right0 = grey((four >> 8) & byte);
  const cv::v_float32x4 left1 = grey((four >> 16) & byte), right1 = grey(four >> 24);
  const cv::v_float32x4 au = u - cv::v_cvt_f32(iu), av = v - cv::v_cvt_f32(iv);
  const cv::v_float32x4 top = left0 + au * (right0 - left0), bottom = left1 + au * (right1 - left1);
  return top + av * (bottom - top);
}

// Bilinear samples of a size x size grid through the warp, row by row. False when one lies outside the image.
bool sample(const cv::Mat& image, const PatchWarp& warp, int size, float* __restrict values) {
  const double radius = 0.5 * (size - 1);
  const Eigen::Vector2d reach =
      radius * warp.linear.cwiseAbs().rowwise().sum() + radius * radius * warp.curvature.cwiseAbs().rowwise().sum();
  // Negated so that a NaN fails too.
  if (!(warp.pixel.x() - reach.x() >= 0 && warp.pixel.y() - reach.y() >= 0 &&
        warp.pixel.x() + reach.x() < image.cols - 1 && warp.pixel.y() + reach.y() < image.rows - 1)) {
    return false;
  }
  const auto* data = image.ptr<std::uint8_t>();
  const auto step = static_cast<std::ptrdiff_t>(image.step);
  if (warp.linear.isIdentity(1e-12) && warp.curvature.isZero(0.0)) {
    const Eigen::Vector2d first = warp.pixel - Eigen::Vector2d::Constant(radius);
    const int x0 = static_cast<int>(first.x());
    const int y0 = static_cast<int>(first.y());
    const float ax = static_cast<float>(first.x() - x0);
    const float ay = static_cast<float>(first.y() - y0);
    const float w00 = (1 - ax) * (1 - ay), w01 = ax * (1 - ay), w10 = (1 - ax) * ay, w11 = ax * ay;
    for (int y = 0; y < size; ++y) {
      const std::uint8_t* upper = data + (y0 + y) * step + x0;
      const std::uint8_t* lower = upper + step;
      for (int x = 0; x < size; ++x) {
        values[x] = w00 * upper[x] + w01 * upper[x + 1] + w10 * lower[x] + w11 * lower[x + 1];
      }
      values += size;
    }
    return true;
  }
  const cv::v_float32x4 curvature_u = cv::v_setall_f32(static_cast<float>(warp.curvature(0, 0)));
  const cv::v_float32x4 curvature_v = cv::v_setall_f32(static_cast<float>(warp.curvature(1, 0)));
  const cv::v_float32x4 lanes(0, 1, 2, 3), last = cv::v_setall_f32(static_cast<float>(size - 1));
  float grey[PatchTemplate::kMaxSize + 2 + 3];  // a row of the patch in whole groups of four
  for (int row = 0; row < size; ++row) {
    // A row of the patch in powers of its column.
    const double y = row - radius;
    const Eigen::Vector2d slope = warp.linear.col(0) + y * warp.curvature.col(1);
    const Eigen::Vector2d middle = warp.pixel + y * warp.linear.col(1) + y * y * warp.curvature.col(2);
    const Eigen::Vector2d start = middle - radius * slope + radius * radius * warp.curvature.col(0);
    const Eigen::Vector2d first_slope = slope - 2.0 * radius * warp.curvature.col(0);
    const float u0 = static_cast<float>(start.x()), v0 = static_cast<float>(start.y());
    const float du = static_cast<float>(first_slope.x()), dv = static_cast<float>(first_slope.y());
    for (int x = 0; x < size; x += 4) {
      const cv::v_float32x4 column = cv::v_min(lanes + cv::v_setall_f32(static_cast<float>(x)), last);
      const cv::v_float32x4 u = cv::v_setall_f32(u0) + (cv::v_setall_f32(du) + curvature_u * column) * column;
      const cv::v_float32x4 v = cv::v_setall_f32(v0) + (cv::v_setall_f32(dv) + curvature_v * column) * column;
      cv::v_store(grey + x, bilinear(data, step, u, v));
    }
    std::copy_n(grey, size, values);
    values += size;
  }
  return true;
}

// Zero-mean normalized cross-correlation of samples with a zero-mean template, given their scalar product.
template <typename Samples>
double normalizedCorrelation(const Samples& samples, double product, double energy) {
  const double mean = samples.mean();
  const double sample_energy = (samples.array() - static_cast<float>(mean)).square().sum();
  return sample_energy > 0 ? product / std::sqrt(sample_energy * energy) : -1.0;
}

}  // namespace

bool PatchTemplate::cut(const cv::Mat& image, const PatchWarp& warp, int size, WarpModel model) {
  size_ = size;
  parameters_ = model == WarpModel::kAffine ? 6 : 2;
  const int n = size * size;
  const int padded = size + 2;
  std::array<float, (kMaxSize + 2) * (kMaxSize + 2)> values;
  if (!sample(image, warp, padded, values.data())) return false;

  columns_.resize(n, parameters_ + 1);
  float* shift_x = columns_.col(0).data();
  float* shift_y = columns_.col(1).data();
  float* intensity = columns_.col(parameters_).data();
  for (int y = 0, i = 0; y < size; ++y) {
    const float* row = &values[(y + 1) * padded + 1];
    for (int x = 0; x < size; ++x, ++i) {
      intensity[i] = row[x];
      shift_x[i] = 0.5f * (row[x + 1] - row[x - 1]);
      shift_y[i] = 0.5f * (row[x + padded] - row[x - padded]);
    }
  }
  if (parameters_ == 6) {
    const float radius = 0.5f * (size - 1);
    for (int y = 0, i = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x, ++i) {
        columns_(i, 2) = shift_x[i] * (x - radius);
        columns_(i, 3) = shift_x[i] * (y - radius);
        columns_(i, 4) = shift_y[i] * (x - radius);
        columns_(i, 5) = shift_y[i] * (y - radius);
      }
    }
  }
  columns_.rowwise() -= columns_.colwise().mean().eval();
  const auto last = columns_.col(parameters_);
  energy_ = last.squaredNorm();
  if (energy_ < n) return false;  // less than one grey level of contrast
  for (int k = 0; k < parameters_; ++k) {
    columns_.col(k) -= static_cast<float>(columns_.col(k).dot(last) / energy_) * last;
  }

  Eigen::Matrix<double, 6, 6> hessian = Eigen::Matrix<double, 6, 6>::Identity();
  for (int r = 0; r < parameters_; ++r) {
    for (int c = 0; c <= r; ++c) hessian(r, c) = hessian(c, r) = columns_.col(r).dot(columns_.col(c));
  }
  const double trace = hessian(0, 0) + hessian(1, 1);
  const double determinant = hessian(0, 0) * hessian(1, 1) - hessian(0, 1) * hessian(0, 1);
  const double min_eigenvalue = 0.5 * (trace - std::sqrt(std::max(0.0, trace * trace - 4 * determinant)));
  if (!(min_eigenvalue > kMinCurvature * n)) return false;
  if (parameters_ == 2) {
    inverse_hessian_.setZero();
    inverse_hessian_.topLeftCorner<2, 2>() = hessian.topLeftCorner<2, 2>().inverse();
  } else {
    hessian.diagonal().tail<4>().array() += kLinearPrecision;
    inverse_hessian_ = hessian.llt().solve(Eigen::Matrix<double, 6, 6>::Identity());
  }
  return true;
}

bool PatchTemplate::align(const cv::Mat& image, const PatchAlignmentOptions& options, PatchWarp* warp,
                          double* correlation) const {
  Eigen::Matrix<float, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxPixels, 1> samples(size_ * size_);
  Eigen::Matrix<float, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxParameters + 1, 1> products =
      Eigen::Matrix<float, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxParameters + 1, 1>::Zero(parameters_ + 1);
  PatchWarp current = *warp;
  bool converged = false;
  for (int iteration = 0; iteration < options.max_iterations && !converged; ++iteration) {
    if (!sample(image, current, size_, samples.data())) return false;
    products.noalias() = columns_.transpose() * samples;
    const double gain = products[parameters_] / energy_;
    if (gain < 0.1) return false;
    Eigen::Vector2d shift = Eigen::Vector2d::Zero();
    if (parameters_ == 2) {
      shift = inverse_hessian_.topLeftCorner<2, 2>() * products.head<2>().cast<double>() / gain;
    } else {
      Vector6d gradient = products.head<6>().cast<double>() / gain;
      const Eigen::Matrix2d deformation = current.linear - Eigen::Matrix2d::Identity();
      gradient[2] += kLinearPrecision * deformation(0, 0);
      gradient[3] += kLinearPrecision * deformation(0, 1);
      gradient[4] += kLinearPrecision * deformation(1, 0);
      gradient[5] += kLinearPrecision * deformation(1, 1);
      const Vector6d step = inverse_hessian_ * gradient;
      shift = step.head<2>();
      Eigen::Matrix2d increment;
      increment << 1 + step[2], step[3], step[4], 1 + step[5];
      if (!(increment.determinant() > 0.25)) return false;
      current.linear = current.linear * increment.inverse();
    }
    shift = current.linear * shift;
    current.pixel -= shift;
    if (!((current.pixel - warp->pixel).squaredNorm() < options.max_shift_px * options.max_shift_px)) return false;
    converged = shift.squaredNorm() < options.epsilon_px * options.epsilon_px;
  }
  // Of the last samples, which the last step has moved by less than epsilon.
  const double reached = normalizedCorrelation(samples, products[parameters_], energy_);
  if (correlation) *correlation = reached;
  if (!converged || !(reached >= options.min_correlation)) return false;
  *warp = current;
  return true;
}

double PatchTemplate::correlation(const cv::Mat& image, const PatchWarp& warp) const {
  Eigen::Matrix<float, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxPixels, 1> samples(size_ * size_);
  if (!sample(image, warp, size_, samples.data())) return -1.0;
  return normalizedCorrelation(samples, samples.dot(columns_.col(parameters_)), energy_);
}

}  // namespace multicam_egomotion
