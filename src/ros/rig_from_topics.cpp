// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "multicam_egomotion/ros/rig_from_topics.h"

#include <tf2/exceptions.h>
#include <tf2_eigen/tf2_eigen.h>

#include <algorithm>
#include <sstream>
#include <stdexcept>

namespace multicam_egomotion {
namespace {

using sensor_msgs::CameraInfo;

/// Position of the camera in the frame that its stereo pair shares, in rectified axes: P = K' [I | -K' p].
Eigen::Vector3d baselineFromProjection(const CameraInfo& info) {
  if (info.P[0] == 0.0 || info.P[5] == 0.0) return Eigen::Vector3d::Zero();
  return {-info.P[3] / info.P[0], -info.P[7] / info.P[5], 0.0};
}

/// Turns the axes of the camera into those of its rectified image; identity where the driver leaves R empty.
Eigen::Matrix3d rectification(const CameraInfo& info) {
  const Eigen::Matrix3d R = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(info.R.data());
  return std::abs(R.determinant() - 1.0) < 0.01 ? R : Eigen::Matrix3d::Identity().eval();
}

Eigen::Isometry3d rotation(const Eigen::Matrix3d& R) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::Quaterniond(R).normalized().toRotationMatrix();
  return T;
}

/// Pose of the unrectified camera `index` in its frame_id: the identity, unless other cameras have the same frame_id.
Eigen::Isometry3d poseInFrame(const std::vector<CameraInfo>& infos, std::size_t index) {
  const CameraInfo& info = infos[index];
  const CameraInfo* first = nullptr;
  bool shared = false, apart = false;
  for (std::size_t i = 0; i < infos.size(); ++i) {
    if (infos[i].header.frame_id != info.header.frame_id) continue;
    if (first == nullptr) first = &infos[i];
    shared = shared || i != index;
    apart = apart || !baselineFromProjection(infos[i]).isZero();
  }
  if (!shared) return Eigen::Isometry3d::Identity();
  if (!apart) {
    throw std::invalid_argument("CameraInfo of camera " + std::to_string(index) + ": found frame_id '" +
                                info.header.frame_id +
                                "' shared with another camera and P[3] = 0 for all of them, expected a frame_id and a "
                                "TF of its own, or the baseline in P[3] = -fx * baseline");
  }
  return rotation(rectification(*first).transpose()) * Eigen::Translation3d(baselineFromProjection(info)) *
         rotation(rectification(info));
}

/// Compares the baselines of P with those of the cameras as placed; P is nobody's first source here.
void checkBaselines(const std::vector<CameraInfo>& infos, const std::vector<RigCamera>& cameras,
                    std::vector<std::string>* warnings) {
  for (std::size_t i = 1; i < infos.size(); ++i) {
    const double stated = baselineFromProjection(infos[i]).norm();
    if (stated == 0.0) continue;
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t j = 0; j < infos.size(); ++j) {
      const double distance = (cameras[i].T_body_cam.translation() - cameras[j].T_body_cam.translation()).norm();
      if (j != i && std::abs(distance - stated) < std::abs(nearest - stated)) nearest = distance;
    }
    if (std::abs(nearest - stated) > 0.05 * stated + 1e-3) {
      std::ostringstream text;
      text << cameras[i].name << ": P gives a baseline of " << stated << " m, TF " << nearest
           << " m to the other camera that fits best; TF is used";
      warnings->push_back(text.str());
    }
  }
}

}  // namespace

std::optional<Eigen::Isometry3d> mountingFromTf(const tf2::BufferCore& tf, const std::string& base_frame,
                                                const std::string& frame) {
  if (frame == base_frame) return Eigen::Isometry3d::Identity();
  try {
    return Eigen::Isometry3d(tf2::transformToEigen(tf.lookupTransform(base_frame, frame, ros::Time(0))).matrix());
  } catch (const tf2::TransformException&) {
    return std::nullopt;
  }
}

CameraModel cameraModelFromInfo(const CameraInfo& info, bool rectified) {
  const std::string who = "CameraInfo of '" + info.header.frame_id + "': ";
  const double fx = rectified ? info.P[0] : info.K[0], fy = rectified ? info.P[5] : info.K[4];
  const double cx = rectified ? info.P[2] : info.K[2], cy = rectified ? info.P[6] : info.K[5];
  if (fx == 0.0) {
    throw std::invalid_argument(who + "found " + (rectified ? "P[0]" : "K[0]") + " = 0, expected a calibrated camera");
  }
  // As image_geometry: the region of interest is in unbinned pixels, the principal point scales with the binning.
  const double bin_x = std::max(1u, info.binning_x), bin_y = std::max(1u, info.binning_y);
  const int width = info.roi.width > 0 ? info.roi.width : info.width;
  const int height = info.roi.height > 0 ? info.roi.height : info.height;
  const bool ideal =
      rectified || info.D.empty() || std::all_of(info.D.begin(), info.D.end(), [](double d) { return d == 0.0; });
  try {
    const bool fisheye = !rectified && info.distortion_model == "equidistant";
    const Distortion distortion = ideal && !fisheye ? Distortion::kNone : distortionFromName(info.distortion_model);
    const std::vector<double> coefficients = distortion == Distortion::kNone ? std::vector<double>() : info.D;
    return CameraModel(static_cast<int>(width / bin_x), static_cast<int>(height / bin_y), fx / bin_x, fy / bin_y,
                       (cx - info.roi.x_offset) / bin_x, (cy - info.roi.y_offset) / bin_y, distortion, coefficients);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(who + error.what());
  }
}

bool sameCalibration(const CameraInfo& a, const CameraInfo& b) {
  return a.header.frame_id == b.header.frame_id && a.width == b.width && a.height == b.height && a.K == b.K &&
         a.D == b.D && a.R == b.R && a.P == b.P && a.distortion_model == b.distortion_model &&
         a.binning_x == b.binning_x && a.binning_y == b.binning_y && a.roi.x_offset == b.roi.x_offset &&
         a.roi.y_offset == b.roi.y_offset && a.roi.width == b.roi.width && a.roi.height == b.roi.height;
}

std::optional<CameraRig> rigFromCameraInfo(const std::vector<CameraInfo>& infos, bool rectified, double time_offset_s,
                                           const tf2::BufferCore& tf, const std::string& base_frame,
                                           std::vector<std::string>* warnings) {
  std::vector<RigCamera> cameras;
  for (std::size_t i = 0; i < infos.size(); ++i) {
    const CameraInfo& info = infos[i];
    const std::optional<Eigen::Isometry3d> T_body_frame = mountingFromTf(tf, base_frame, info.header.frame_id);
    if (!T_body_frame) return std::nullopt;
    Eigen::Isometry3d T_body_cam = *T_body_frame * poseInFrame(infos, i);
    if (rectified) T_body_cam = T_body_cam * rotation(rectification(info).transpose());
    cameras.push_back({"cam" + std::to_string(i), info.header.frame_id, cameraModelFromInfo(info, rectified),
                       T_body_cam, time_offset_s});
  }
  checkBaselines(infos, cameras, warnings);
  return CameraRig(std::move(cameras));
}

}  // namespace multicam_egomotion
