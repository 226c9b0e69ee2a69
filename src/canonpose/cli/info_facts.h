// What a file of ours is, what it holds and where it came from, as JSON: `info` prints it as it is or in words.
//
//   of all files  file, kind: dataset, model, checkpoint, npz, or as below
//   dataset       frames, fingerprint, skeleton, source, sequences [{name, subject, frames, fps, static_cameras,
//                 capture, actions, truth_kind, cameras [{name, image_size, seen_percent, truth, solved,
//                 calibrated}]}]
//   model and     program_version, preset, network, width, seed, steps, mirror {decision, slope, slope_error}, trap
//   checkpoint    {verdict, depth_ratio, angle_deg, scatter_deg}, morph {width}, perspective, data [{file,
//                 fingerprint}], skeleton, source, options {...}
//   scene         .h5, or .json of export: name, unit, up, floor, scale (what they are known from), frames, fps, people
//                 [{name, joints}], cameras [{name, image_size, used, calibrated}]
//   npz           arrays [{name, shape, text}]
//   poses         of lift or export, .csv, or of lift, .json: written_by, frames, units, joints
//   errors        of single poses, .csv: poses, columns
//   evaluation    .json: protocol, frames, n_mpjpe_mm, p_mpjpe_mm
//   solve report  .json: captures; protocols: protocols; calibration: cameras [name]
//
// with skeleton {name, joints, parents, root} (indices) and source {format, layout, confidence_scale, mapping, morph}.
// What is not known or does not apply is null.
#pragma once

#include <filesystem>

#include <nlohmann/json.hpp>

namespace canonpose {

using Facts = nlohmann::ordered_json;

/// `path` is a file, or the folder of a training run, finished or not. Throws Error(kBadInput) where there is none, or
/// it is damaged or of another kind.
Facts FactsOf(const std::filesystem::path& path);

}  // namespace canonpose
