#include "canonpose/data/track_arrays.h"

#include <limits>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "canonpose/base/error.h"

namespace canonpose {

void ReadTracks(const h5::Group& camera, const Skeleton& skeleton, int frame_count, CameraView& view) {
  if (frame_count < 0) {
    camera.Fail("tracks", "the attribute frames of the sequence, the number of frames of all tracks", "nothing", "");
  }
  const auto frames = static_cast<std::size_t>(frame_count);
  const std::size_t joints = skeleton.joints.size();
  view.keypoints.assign(frames * joints * 2, std::numeric_limits<float>::quiet_NaN());
  view.confidence.assign(frames * joints, 0.0F);
  const h5::Group tracks = camera.Open("tracks");
  for (const std::string& id : tracks.Children()) {
    const h5::Group group = tracks.Open(id);
    CameraTrack track;
    track.id = id;
    track.keypoints = ReadArray(group, "keypoints", {frames, joints, 2}, "frames, joints of /skeleton, x and y");
    track.confidence = ReadArray(group, "confidence", {frames, joints}, "frames, joints");
    CheckKeypoints({group.file(), group.path(), &skeleton}, track.keypoints, track.confidence);
    view.tracks.push_back(std::move(track));
  }
}

void WriteTracks(const DatasetPlace& place, CameraView& view, int frame_count, h5::Group& camera) {
  const auto frames = static_cast<std::size_t>(frame_count);
  const std::size_t joints = place.skeleton->joints.size();
  h5::Group tracks = camera.Create("tracks");
  for (CameraTrack& track : view.tracks) {
    if (track.id.empty() || track.id == "." || track.id == ".." || track.id.find('/') != std::string::npos) {
      ThrowBadInput({place.file, tracks.path(), "a name for the track without '/'", '"' + track.id + '"', "rename it"});
    }
    CANONPOSE_CHECK(track.keypoints.size() == frames * joints * 2 && track.confidence.size() == frames * joints,
                    "{} and {} values for {} frames", track.keypoints.size(), track.confidence.size(), frames);
    h5::Group group = tracks.Create(track.id);
    CheckKeypoints({place.file, group.path(), place.skeleton}, track.keypoints, track.confidence);
    group.Write<float>("keypoints", std::span<const float>(track.keypoints), {frames, joints, 2});
    group.Write<float>("confidence", std::span<const float>(track.confidence), {frames, joints});
  }
}

}  // namespace canonpose
