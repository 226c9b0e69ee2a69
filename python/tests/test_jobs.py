"""Import, solve, evaluate, train, lift: what the commands do."""
import json
import logging
import os
import pathlib
import signal
import threading
import time

import numpy as np
import pytest

import canonpose

TESTDATA = pathlib.Path(__file__).parents[2] / "testdata"


def first(dataset):
    return next(iter(dataset.sequences.values()))


def test_import_reads_a_detectors_files(tmp_path):
    folder = TESTDATA / "detections" / "openpose"
    dataset = canonpose.import_keypoints("openpose", folder, image_size=(640, 480), layout="body_25", fps=30, name="walk")
    sequence = dataset.sequences["walk"]
    assert list(sequence.cameras) == ["cam1", "cam2"] and sequence.fps == 30
    assert sequence.cameras["cam1"].keypoints.shape == (len(sequence), 17, 2)
    people = json.loads(sorted((folder / "cam1").iterdir())[0].read_text())["people"]
    knee = sequence.cameras["cam1"].keypoints[0, dataset.skeleton.index("RKnee")]
    assert any(np.allclose(knee, person["pose_keypoints_2d"][30:32]) for person in people)
    named = canonpose.import_keypoints("openpose", cameras={"left": folder / "cam2", "right": folder / "cam1"},
                                       image_size=(640, 480), layout="body_25", skeleton="native")
    assert sorted(named.sequences["clip"].cameras) == ["left", "right"] and len(named.skeleton) == 25
    with pytest.raises(canonpose.InvalidArgument, match="align"):
        canonpose.import_keypoints("openpose", folder, align="by ear")
    with pytest.raises(canonpose.BadInput):
        canonpose.import_keypoints("openpose", tmp_path / "nothing", image_size=(640, 480))


def test_solve_finds_poses_and_leaves_its_input(dataset, solved):
    assert all(view.solved is None for view in first(dataset).cameras.values())
    views = first(solved.dataset).cameras
    assert all(view.solved.positions.shape == view.keypoints.shape[:2] + (3,) for view in views.values())
    assert all(len(view.solved_calibration) == 1 for view in views.values())
    assert solved.doubt == "" and solved.report["captures"][0]["frames_solved"] == len(first(dataset))
    assert "camera" in str(solved)


def test_the_scene_reprojects_onto_the_keypoints(dataset, solved):
    scene, = solved.scenes
    person, = scene.people
    for camera in scene.cameras:
        points = person.positions[10].astype(float)
        error = camera.calibration[0].project(points) - first(dataset).cameras[camera.name].keypoints[10]
        assert np.nanmedian(np.hypot(*error.T)) < 10


def test_solve_takes_sizes(dataset):
    scene, = canonpose.solve(dataset, height=1.75, threads=1).scenes
    assert "1.75" in scene.scale and scene.up and scene.floor
    heights = np.nanmax(scene.people[0].positions[..., 2], axis=1)
    assert 1200 < np.median(heights) < 2000  # mm above the floor; the head's top is no joint
    with pytest.raises(canonpose.InvalidArgument, match="height"):
        canonpose.solve(dataset, height=175)
    with pytest.raises(canonpose.InvalidArgument, match="camera_distance"):
        canonpose.solve(dataset, camera_distances={("cam1", "nobody"): 2.0})


def test_the_lines_of_the_readme_make_an_animation(dataset, tmp_path, monkeypatch):
    readme = pathlib.Path(__file__).parents[2] / "README.md"
    code = readme.read_text().split("```python\n")[1].split("```")[0]
    monkeypatch.chdir(tmp_path)
    dataset.write("data.h5")
    exec(compile(code, str(readme), "exec"), {})
    content = pathlib.Path("person.glb").read_bytes()
    assert content[:4] == b"glTF" and int.from_bytes(content[8:12], "little") == len(content)


def test_evaluate_gives_figures(solved, tmp_path):
    figures = canonpose.evaluate(solved.dataset)
    assert 0 < figures["p_mpjpe_mm"] < 40 and figures["p_mpjpe_mm"] < figures["n_mpjpe_mm"]
    solved.dataset.write(tmp_path / "solved.h5")
    assert canonpose.evaluate([tmp_path / "solved.h5"])["p_mpjpe_mm"] == figures["p_mpjpe_mm"]
    assert canonpose.evaluate(solved.dataset, triangulate=True)["p_mpjpe_mm"] > 0


def test_messages_go_to_the_logger(caplog):
    with caplog.at_level(logging.INFO, logger="canonpose"):
        canonpose.import_keypoints("alphapose", TESTDATA / "detections" / "alphapose_136", image_size=(640, 480))
    assert caplog.records and all(record.name == "canonpose" for record in caplog.records)


def test_progress_is_reported_and_may_stop_the_work(dataset, solved, progress):
    assert progress
    for label, done, total, detail in progress:
        assert isinstance(label, str) and 0 <= done <= total and isinstance(detail, str)

    def refuse(*state):
        raise KeyError("enough")

    with pytest.raises(KeyError, match="enough"):
        canonpose.solve(dataset, threads=1, progress=refuse)


def test_ctrl_c_interrupts_and_other_threads_run_meanwhile():
    recording = canonpose.simulate(subjects=2, clips=2, seconds=20, activities=["gait"], seed=3)
    counted = 0

    def interrupt():
        nonlocal counted
        until = time.monotonic() + 1.0
        while time.monotonic() < until:
            counted += 1
            time.sleep(0.001)
        os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=interrupt)
    thread.start()
    began = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        canonpose.solve(recording)
        time.sleep(30)  # were it faster than a second
    thread.join()
    assert time.monotonic() - began < 25
    assert counted > 100  # the interpreter's lock was free


def trains():
    try:
        canonpose.open_model("nothing")
    except canonpose.InvalidArgument:
        return False
    except canonpose.Error:
        return True


@pytest.mark.skipif(not trains(), reason="built without LibTorch")
def test_train_and_lift(solved, tmp_path):
    model = canonpose.train(solved.dataset, tmp_path / "run", width=32, epochs=2, min_steps=20, threads=1)
    view = next(iter(first(solved.dataset).cameras.values()))
    with pytest.raises(canonpose.InvalidArgument, match="nonsense"):
        canonpose.train(solved.dataset, tmp_path / "other", nonsense=1)
    with pytest.raises(canonpose.InvalidArgument):  # there is a run already
        canonpose.train(solved.dataset, tmp_path / "run", width=32, epochs=2)
    lifted = canonpose.lift(model, np.dstack([view.keypoints, view.confidence]), image_size=tuple(view.image_size), height=1.7)
    poses = lifted.pose_in_camera
    assert poses.positions.shape == (len(view.keypoints), 17, 3) and poses.unit == "mm"
    seen = np.isfinite(poses.positions).all(axis=2)
    assert seen.mean() > 0.8 and (poses.confidence[seen] > 0).all()
    rotation = lifted.rotation[0].astype(float)
    np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-4)
    np.testing.assert_allclose(lifted.canonical.positions[0] @ rotation.T, poses.positions[0], atol=1)
    # The same from a file.
    solved.dataset.write(tmp_path / "data.h5")
    again = canonpose.lift(tmp_path / "run", tmp_path / "data.h5", camera=view.name, height=1.7)
    np.testing.assert_array_equal(again.pose_in_camera.positions, poses.positions)
    again.write(tmp_path / "out.npz")
    assert np.load(tmp_path / "out.npz")["pose3d"].shape == poses.positions.shape
    figures = canonpose.evaluate(solved.dataset, model=tmp_path / "run")
    assert figures["n_mpjpe_mm"] > 0


def test_the_example_draws_knee_angles(solved, tmp_path, monkeypatch):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    import runpy
    solved.dataset.write(tmp_path / "solved.h5")
    monkeypatch.setattr("sys.argv", ["knee_angle.py", str(tmp_path / "solved.h5"), str(tmp_path / "knee.png")])
    runpy.run_path(str(pathlib.Path(__file__).parents[2] / "examples" / "knee_angle.py"), run_name="__main__")
    assert (tmp_path / "knee.png").read_bytes().startswith(b"\x89PNG")
