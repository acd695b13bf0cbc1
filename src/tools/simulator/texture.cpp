// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/texture.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>

#include "simulator/random.h"

namespace multicam_egomotion {

namespace {

// Draws a convex leaf (ellipse, rectangle, triangle...) with the image's period; 1/256 texel.
void drawLeaf(cv::Mat& image, double x, double y, double radius, Random& random) {
  const int corners = random.uniform() < 0.2 ? 16 : 3 + random.index(3);
  const double turn = random.uniform(0.0, 2.0 * M_PI), aspect = random.uniform(0.4, 1.0);
  const double slant = random.uniform(0.0, M_PI);
  double px[16], py[16];
  for (int i = 0; i < corners; ++i) {
    const double angle = turn + 2.0 * M_PI * i / corners;
    const double a = radius * std::cos(angle), b = radius * aspect * std::sin(angle);
    px[i] = std::cos(slant) * a - std::sin(slant) * b;
    py[i] = std::sin(slant) * a + std::cos(slant) * b;
  }
  const cv::Scalar grey(random.uniform(25.0, 230.0));
  const int size = image.rows;
  for (int wrap_y = -1; wrap_y <= 1; ++wrap_y) {
    for (int wrap_x = -1; wrap_x <= 1; ++wrap_x) {
      const double cx = x + wrap_x * size, cy = y + wrap_y * size;
      if (cx + radius < -1 || cx - radius > size || cy + radius < -1 || cy - radius > size) continue;
      cv::Point points[16];
      for (int i = 0; i < corners; ++i) points[i] = cv::Point(cvRound(256 * (cx + px[i])), cvRound(256 * (cy + py[i])));
      cv::fillConvexPoly(image, points, corners, grey, cv::LINE_AA, 8);
    }
  }
}

}  // namespace

Texture::Texture(int size, std::uint64_t seed) {
  if (size < 2 || (size & (size - 1)) != 0) {
    throw std::invalid_argument("Texture: size is " + std::to_string(size) + ", expected a power of two");
  }
  Random random(seed, 7);
  cv::Mat image(size, size, CV_8UC1, cv::Scalar(128));
  // From large to small: the large ones cover everything, each smaller size the same small share of it.
  for (double radius = size / 8.0; radius > 4.0; radius /= 1.3) {
    const double area = 1.6 * radius * radius, share = radius > size / 32.0 ? 0.5 : 0.045;
    const int count = static_cast<int>(std::ceil(share * size * static_cast<double>(size) / area));
    for (int i = 0; i < count; ++i) {
      const double x = random.uniform(0, size), y = random.uniform(0, size);
      drawLeaf(image, x, y, radius * random.uniform(0.8, 1.25), random);
    }
  }
  cv::Mat level = image;
  for (int texels = size; texels >= 1; texels /= 2) {
    if (texels < size) {
      cv::Mat half;
      cv::resize(level, half, cv::Size(texels, texels), 0, 0, cv::INTER_AREA);
      level = half;
    }
    const float scale = static_cast<float>(texels) / static_cast<float>(size);
    mipmaps_.push_back({std::vector<std::uint8_t>(level.datastart, level.dataend), texels, scale});
  }
}

Texture::Level Texture::levelFor(float footprint) const {
  if (!(footprint > 1.0f)) return {0, 0.0f};
  // log2, linear between powers of two: no more than 0.09 of a level off.
  int exponent;
  const float mantissa = std::frexp(footprint, &exponent);
  const int last = static_cast<int>(mipmaps_.size()) - 1;
  if (exponent - 1 >= last) return {last, 0.0f};
  return {exponent - 1, 2.0f * mantissa - 1.0f};
}

}  // namespace multicam_egomotion
