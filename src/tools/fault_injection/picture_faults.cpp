// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fault_injection/picture_faults.h"

#include <cv_bridge/cv_bridge.h>

#include <algorithm>
#include <boost/make_shared.hpp>
#include <cmath>
#include <map>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "simulator/random.h"

namespace multicam_egomotion {
namespace {

/// Changes pixels; `white` is the largest value a channel can have.
using Alter = std::function<void(cv::Mat* pixels, double white)>;

double whiteOf(const cv::Mat& pixels) { return pixels.depth() == CV_16U ? 65535.0 : 255.0; }

void alterRaw(RecordedMessage* message, const Alter& alter) {
  const auto image = copyOf<sensor_msgs::Image>(*message);
  const int type = cv_bridge::getCvType(image->encoding);
  const std::size_t row = static_cast<std::size_t>(image->width) * CV_ELEM_SIZE(type);
  if (image->step < row || image->data.size() < static_cast<std::size_t>(image->step) * image->height) return;
  cv::Mat pixels =
      cv::Mat(static_cast<int>(image->height), static_cast<int>(image->width), type, image->data.data(), image->step)
          .clone();
  alter(&pixels, whiteOf(pixels));
  image->width = pixels.cols;
  image->height = pixels.rows;
  image->step = static_cast<std::uint32_t>(pixels.cols * pixels.elemSize());
  image->data.assign(pixels.datastart, pixels.dataend);
  message->content = sensor_msgs::ImageConstPtr(image);
}

void alterCompressed(RecordedMessage* message, const Alter& alter) {
  const auto image = copyOf<sensor_msgs::CompressedImage>(*message);
  cv::Mat pixels;
  if (!image->data.empty()) pixels = cv::imdecode(image->data, cv::IMREAD_UNCHANGED);
  if (pixels.empty()) return;
  alter(&pixels, whiteOf(pixels));
  const bool png = image->format.find("png") != std::string::npos;
  cv::imencode(png ? ".png" : ".jpg", pixels, image->data);
  message->content = sensor_msgs::CompressedImageConstPtr(image);
}

/// Pixels that cannot be decoded stay as they are.
void alterPixels(RecordedMessage* message, const Alter& alter) {
  try {
    if (std::holds_alternative<sensor_msgs::ImageConstPtr>(message->content)) {
      alterRaw(message, alter);
    } else {
      alterCompressed(message, alter);
    }
  } catch (const cv_bridge::Exception&) {  // an encoding that is not known
  }
}

/// `alter` sees the seconds since `from`.
Fault alteredImages(const FaultSetting& setting, std::function<void(cv::Mat*, double white, double time_s)> alter) {
  return [setting, alter](RecordedMessage message, const Emit& emit) {
    if (setting.activeImage(message)) {
      const double time_s = setting.since(message, "from");
      alterPixels(&message, [&](cv::Mat* pixels, double white) { alter(pixels, white, time_s); });
    }
    emit(std::move(message));
  };
}

void brighten(cv::Mat* pixels, double factor) { pixels->convertTo(*pixels, -1, factor); }

/// Squares of 8 pixels with random grey levels.
cv::Mat randomTexture(const cv::Size& size, int type, double white, std::uint64_t seed) {
  constexpr int kSquare = 8;
  cv::Mat texture(size, type);
  Random random(seed);
  for (int y = 0; y < size.height; y += kSquare) {
    for (int x = 0; x < size.width; x += kSquare) {
      const cv::Rect square = cv::Rect(x, y, kSquare, kSquare) & cv::Rect(cv::Point(), size);
      texture(square).setTo(cv::Scalar::all(random.uniform(0.0, white)));
    }
  }
  return texture;
}

template <class Value>
void addNoise(cv::Mat* pixels, double sigma, Random* random) {
  for (int y = 0; y < pixels->rows; ++y) {
    Value* row = pixels->ptr<Value>(y);
    for (int i = 0; i < pixels->cols * pixels->channels(); ++i) {
      row[i] = cv::saturate_cast<Value>(row[i] + sigma * random->gaussian());
    }
  }
}

}  // namespace

Fault imageSize(const FaultSetting& setting) {
  const double scale = setting.values.number("scale");
  return alteredImages(setting, [scale](cv::Mat* pixels, double, double) {
    const cv::Size size(std::max<int>(1, std::lround(scale * pixels->cols)),
                        std::max<int>(1, std::lround(scale * pixels->rows)));
    cv::Mat resized;
    cv::resize(*pixels, resized, size, 0.0, 0.0, cv::INTER_AREA);
    *pixels = resized;
  });
}

Fault imageBlank(const FaultSetting& setting) {
  const double grey = setting.values.number("grey") / 255.0;
  return alteredImages(setting,
                       [grey](cv::Mat* pixels, double white, double) { pixels->setTo(cv::Scalar::all(grey * white)); });
}

Fault imageGain(const FaultSetting& setting) {
  const double factor = setting.values.number("factor");
  return alteredImages(setting, [factor](cv::Mat* pixels, double, double) { brighten(pixels, factor); });
}

Fault imageNoise(const FaultSetting& setting) {
  const double sigma = setting.values.number("sigma") / 255.0;
  return alteredImages(setting,
                       [sigma, random = std::make_shared<Random>(setting.seed)](cv::Mat* pixels, double white, double) {
                         if (pixels->depth() == CV_16U) {
                           addNoise<std::uint16_t>(pixels, sigma * white, random.get());
                         } else {
                           addNoise<std::uint8_t>(pixels, sigma * white, random.get());
                         }
                       });
}

Fault imageFrozen(const FaultSetting& setting) {
  using Content = decltype(RecordedMessage::content);
  return [setting, first = std::map<std::string, Content>()](RecordedMessage message, const Emit& emit) mutable {
    if (setting.activeImage(message)) {
      std_msgs::Header header;
      changeHeader(&message, [&](std_msgs::Header* own) { header = *own; });
      message.content = first.emplace(message.topic, message.content).first->second;
      changeHeader(&message, [&](std_msgs::Header* frozen) { *frozen = header; });
    }
    emit(std::move(message));
  };
}

Fault exposureSteps(const FaultSetting& setting) {
  const double factor = setting.values.number("factor"), period_s = setting.values.number("period");
  return alteredImages(setting, [factor, period_s](cv::Mat* pixels, double, double time_s) {
    if (static_cast<long>(time_s / period_s) % 2 == 0) brighten(pixels, factor);
  });
}

Fault obstruction(const FaultSetting& setting) {
  const FaultValues& values = setting.values;
  const cv::Rect2d part(values.number("x"), values.number("y"), values.number("width"), values.number("height"));
  const double grey = values.number("grey") / 255.0;
  return alteredImages(setting, [part, grey](cv::Mat* pixels, double white, double) {
    const cv::Rect covered(cvRound(part.x * pixels->cols), cvRound(part.y * pixels->rows),
                           cvRound(part.width * pixels->cols), cvRound(part.height * pixels->rows));
    (*pixels)(covered & cv::Rect(cv::Point(), pixels->size())).setTo(cv::Scalar::all(grey * white));
  });
}

Fault movingObject(const FaultSetting& setting) {
  const double size = setting.values.number("size"), speed = setting.values.number("speed");
  const std::uint64_t seed = setting.seed;
  return alteredImages(setting, [size, speed, seed](cv::Mat* pixels, double white, double time_s) {
    const cv::Size object(std::max(1, cvRound(size * pixels->cols)), std::max(1, cvRound(size * pixels->rows)));
    // Comes in on the left, leaves on the right, comes in again.
    const int way = pixels->cols + object.width;
    const int x = static_cast<int>(std::fmod(speed * time_s, way)) - object.width;
    const cv::Rect place(cv::Point(x, (pixels->rows - object.height) / 2), object);
    const cv::Rect seen = place & cv::Rect(cv::Point(), pixels->size());
    if (seen.empty()) return;
    const cv::Mat texture = randomTexture(object, pixels->type(), white, seed);
    texture(seen - place.tl()).copyTo((*pixels)(seen));
  });
}

}  // namespace multicam_egomotion
