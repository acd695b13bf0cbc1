// SPDX-FileCopyrightText: 2026 multicam_egomotion authors
// SPDX-License-Identifier: BSD-3-Clause
#include "paper_experiments/kitti_sequence.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "multicam_egomotion/tracking/image_point.h"

namespace multicam_egomotion {
namespace {

namespace fs = std::filesystem;

constexpr int kSearchDepth = 3;
constexpr std::int64_t kFirstStamp = 1000000000;         // a stamp of 0 means none
constexpr int kTracksWidth = 1242, kTracksHeight = 375;  // of the images that were tracked; only bounds

// Numbers of a line after its label, if it has one; separators are blanks and commas.
std::vector<double> numbersOf(std::string line) {
  std::replace(line.begin(), line.end(), ',', ' ');
  std::istringstream words(line);
  std::vector<double> numbers;
  for (std::string word; words >> word;) {
    char* end = nullptr;
    const double value = std::strtod(word.c_str(), &end);
    if (*end == '\0') numbers.push_back(value);
  }
  return numbers;
}

std::vector<std::string> linesOf(const fs::path& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error(path.string() + ": cannot be read");
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}

std::vector<double> row(const fs::path& path, const std::string& line, std::size_t count) {
  const std::vector<double> numbers = numbersOf(line);
  if (numbers.size() == count) return numbers;
  throw std::runtime_error(path.string() + ": found " + std::to_string(numbers.size()) + " numbers in \"" + line +
                           "\", expected " + std::to_string(count));
}

// By the label that starts a line, without its colon.
std::map<std::string, std::string> labelledLines(const fs::path& path) {
  std::map<std::string, std::string> lines;
  for (const std::string& line : linesOf(path)) {
    const std::size_t end = line.find_first_of(": ");
    if (end != std::string::npos) lines[line.substr(0, end)] = line.substr(end + 1);
  }
  return lines;
}

std::vector<double> labelled(const fs::path& path, const std::map<std::string, std::string>& lines,
                             const std::string& label, std::size_t count) {
  const auto found = lines.find(label);
  if (found == lines.end()) throw std::runtime_error(path.string() + ": found no " + label);
  return row(path, found->second, count);
}

// x forward, y left, z up of the body in the axes of the camera.
Eigen::Matrix3d bodyFromCamera() {
  Eigen::Matrix3d R;
  R << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return R;
}

CameraRig stereoRig(int width, int height, double fx, double fy, double cx, double cy, double baseline) {
  std::vector<RigCamera> cameras;
  for (int i : {0, 1}) {
    Eigen::Isometry3d T_body_cam = Eigen::Isometry3d::Identity();
    T_body_cam.linear() = bodyFromCamera();
    T_body_cam.translation() = bodyFromCamera() * Eigen::Vector3d(i * baseline, 0.0, 0.0);
    const std::string name = "cam" + std::to_string(i);
    cameras.push_back({name, name, CameraModel(width, height, fx, fy, cx, cy, Distortion::kNone, {}), T_body_cam, 0.0});
  }
  return CameraRig(cameras);
}

// Poses of the left camera, of which the world is turned by `R_up_world`; and stamps.
void readPoses(const fs::path& poses, const fs::path& times, const Eigen::Matrix3d& R_up_world, int frames,
               KittiSequence* sequence) {
  const std::vector<std::string> stamps = linesOf(times);
  for (const std::string& line : linesOf(poses)) {
    const std::size_t i = sequence->T_world_body.size();
    if ((frames > 0 && i == static_cast<std::size_t>(frames)) || i == stamps.size()) break;
    const std::vector<double> numbers = row(poses, line, 12);
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    for (int k = 0; k < 12; ++k) T.matrix()(k / 4, k % 4) = numbers[k];
    Eigen::Isometry3d T_world_body = Eigen::Isometry3d::Identity();
    T_world_body.linear() =
        Eigen::Quaterniond(R_up_world * T.linear() * bodyFromCamera().transpose()).normalized().toRotationMatrix();
    T_world_body.translation() = R_up_world * T.translation();
    sequence->T_world_body.push_back(T_world_body);
    sequence->stamps_ns.push_back(kFirstStamp + std::llround(1e9 * row(times, stamps[i], 1)[0]));
  }
}

FeatureObservation observation(const CameraModel& model, TrackId track, int camera, const Eigen::Vector2d& pixel) {
  ImagePoint point;
  if (!makeImagePoint(model, pixel, &point)) throw std::runtime_error("pixel that the camera does not see");
  return {track, camera, pixel, point.bearing, bearingToPixel(point)};
}

void readTracks(const fs::path& path, KittiSequence* sequence) {
  sequence->frames.resize(sequence->stamps_ns.size());
  for (std::size_t i = 0; i < sequence->frames.size(); ++i) sequence->frames[i].stamp_ns = sequence->stamps_ns[i];
  bool header = true;
  for (const std::string& line : linesOf(path)) {
    if (std::exchange(header, false)) continue;
    const std::vector<double> numbers = row(path, line, 6);
    const auto frame = static_cast<std::size_t>(numbers[0]);
    if (frame >= sequence->frames.size()) continue;
    for (int camera : {0, 1}) {
      sequence->frames[frame].observations.push_back(observation(sequence->rig.camera(camera).model,
                                                                 static_cast<TrackId>(numbers[1]) + 1, camera,
                                                                 {numbers[2 + 2 * camera], numbers[3 + 2 * camera]}));
    }
  }
  for (TrackedFrame& frame : sequence->frames) {
    std::sort(frame.observations.begin(), frame.observations.end(), [](const auto& a, const auto& b) {
      return a.track != b.track ? a.track < b.track : a.camera < b.camera;
    });
  }
}

// Drives of the raw recordings that are sequences of the odometry benchmark.
std::string sequenceOfDrive(const std::string& drive) {
  static const std::map<std::string, std::string> kSequences = {
      {"2011_10_03_drive_0027", "00"}, {"2011_10_03_drive_0042", "01"}, {"2011_10_03_drive_0034", "02"},
      {"2011_09_26_drive_0067", "03"}, {"2011_09_30_drive_0016", "04"}, {"2011_09_30_drive_0018", "05"},
      {"2011_09_30_drive_0020", "06"}, {"2011_09_30_drive_0027", "07"}, {"2011_09_30_drive_0028", "08"},
      {"2011_09_30_drive_0033", "09"}, {"2011_09_30_drive_0034", "10"}};
  const auto found = kSequences.find(drive.substr(0, 21));  // "_sync" may follow
  return found == kSequences.end() ? drive : found->second;
}

fs::path posesOf(const fs::path& sequence) {
  return sequence.parent_path().parent_path() / "poses" / (sequence.filename().string() + ".txt");
}

void search(const fs::path& directory, int depth, std::vector<KittiFolder>* found) {
  if (fs::exists(directory / "tracks.csv") && fs::exists(directory / "poses.txt")) {
    found->push_back({sequenceOfDrive(directory.filename().string()), "tracks", directory.string()});
    return;
  }
  if (fs::exists(directory / "calib.txt")) {
    if (fs::exists(posesOf(directory))) {
      found->push_back({directory.filename().string(), "images", directory.string()});
    }
    return;
  }
  if (depth == 0) return;
  for (const fs::directory_entry& entry : fs::directory_iterator(directory)) {
    if (entry.is_directory()) search(entry.path(), depth - 1, found);
  }
}

}  // namespace

const std::vector<std::string>& kittiSequenceNames() {
  static const std::vector<std::string> names = {"00", "01", "02", "03", "04", "05", "06", "07", "08", "09", "10"};
  return names;
}

std::vector<KittiFolder> findKittiFolders(const std::string& root) {
  if (!fs::is_directory(root)) throw std::runtime_error(root + ": found no such directory");
  std::vector<KittiFolder> found;
  search(fs::canonical(root), kSearchDepth, &found);
  std::sort(found.begin(), found.end(), [](const KittiFolder& a, const KittiFolder& b) {
    return std::make_pair(a.sequence, a.path) < std::make_pair(b.sequence, b.path);
  });
  return found;
}

std::vector<Eigen::Isometry3d> KittiSequence::cameraPoses() const {
  std::vector<Eigen::Isometry3d> poses;
  for (const RigCamera& camera : rig.cameras()) poses.push_back(camera.T_body_cam);
  return poses;
}

KittiSequence loadKittiSequence(const KittiFolder& folder, int frames) {
  const fs::path path(folder.path);
  const fs::path calibration = path / "calib.txt";
  const std::map<std::string, std::string> lines = labelledLines(calibration);
  if (folder.source == "tracks") {
    const auto value = [&](const char* label) { return labelled(calibration, lines, label, 1)[0]; };
    KittiSequence sequence{
        folder,
        stereoRig(kTracksWidth, kTracksHeight, value("fu"), value("fv"), value("cu"), value("cv"), value("baseline")),
        {},
        {},
        {}};
    readPoses(path / "poses.txt", path / "times.txt", Eigen::Matrix3d::Identity(), frames, &sequence);
    readTracks(path / "tracks.csv", &sequence);
    return sequence;
  }
  const std::vector<double> left = labelled(calibration, lines, "P0", 12);
  const std::vector<double> right = labelled(calibration, lines, "P1", 12);
  const cv::Mat image = cv::imread((path / "image_0" / "000000.png").string(), cv::IMREAD_GRAYSCALE);
  if (image.empty()) throw std::runtime_error(path.string() + "/image_0: found no 000000.png");
  KittiSequence sequence{
      folder,
      stereoRig(image.cols, image.rows, left[0], left[5], left[2], left[6], -right[3] / right[0] + left[3] / left[0]),
      {},
      {},
      {}};
  readPoses(posesOf(path), path / "times.txt", bodyFromCamera(), frames, &sequence);
  return sequence;
}

FrameSet kittiImages(const KittiSequence& sequence, std::size_t frame) {
  FrameSet set;
  set.stamp_ns = sequence.stamps_ns[frame];
  char file[16];
  std::snprintf(file, sizeof file, "%06d.png", static_cast<int>(frame));
  for (int camera : {0, 1}) {
    const fs::path path = fs::path(sequence.folder.path) / ("image_" + std::to_string(camera)) / file;
    CameraImage image{camera, set.stamp_ns, cv::imread(path.string(), cv::IMREAD_GRAYSCALE)};
    if (image.grey.empty()) throw std::runtime_error(path.string() + ": cannot be read");
    set.images.push_back(image);
  }
  return set;
}

}  // namespace multicam_egomotion
