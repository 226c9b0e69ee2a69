"""Datasets, poses, cameras and scenes as NumPy arrays."""
import gc
import pathlib

import numpy as np
import pytest

import canonpose

SKELETON = canonpose.Skeleton.named("h36m-17")


def person(frames=5):
    positions = np.random.default_rng(1).normal(size=(frames, 17, 3)).astype(np.float32)
    return canonpose.PoseSequence(SKELETON, positions, fps=50, unit="mm", name="Ann"), positions


def test_skeletons():
    assert len(SKELETON) == 17 and SKELETON.joints[SKELETON.root] == "Hip"
    assert SKELETON.mirror[SKELETON.index("LKnee")] == SKELETON.index("rknee")
    stick = canonpose.Skeleton(["root", "tip"], [-1, 0])
    assert stick.parents == (-1, 0) and stick.mirror == (0, 1)
    with pytest.raises(canonpose.InvalidArgument, match="no joint LToe"):
        SKELETON.index("LToe")
    with pytest.raises(ValueError, match="no skeleton"):
        canonpose.Skeleton(["a", "b"], [-1, -1])


def test_poses_are_views_of_the_same_memory():
    poses, positions = person()
    np.testing.assert_array_equal(poses.positions, positions)
    poses.positions[2, 3] = 7
    assert poses.positions[2, 3, 1] == 7 and positions[2, 3, 1] != 7
    assert np.shares_memory(poses.positions, poses.positions)
    assert poses.confidence.shape == (5, 17) and (poses.confidence == 1).all()
    assert np.isnan(poses.standard_deviation).all()
    np.testing.assert_allclose(poses.time, np.arange(5) / 50)
    copy = poses.copy()
    assert not np.shares_memory(copy.positions, poses.positions)


def test_arrays_outlive_their_objects(dataset):
    sequence = next(iter(dataset.copy().sequences.values()))
    keypoints = next(iter(sequence.cameras.values())).keypoints
    del sequence
    before = keypoints.copy()
    gc.collect()
    junk = [np.full_like(before, 3) for _ in range(50)]
    np.testing.assert_array_equal(keypoints, before)
    assert len(junk) == 50
    people = canonpose.Scene([person()[0]]).people
    gc.collect()
    assert people[0].name == "Ann" and people[0].positions.shape == (5, 17, 3)


def test_shapes_are_checked():
    with pytest.raises(canonpose.InvalidArgument, match=r"`positions`: expected an array of shape \(any, 17, 3\), found \(2, 16, 3\)"):
        canonpose.PoseSequence(SKELETON, np.zeros((2, 16, 3)))
    with pytest.raises(canonpose.InvalidArgument, match="`unit`: expected mm"):
        canonpose.PoseSequence(SKELETON, np.zeros((2, 17, 3)), unit="furlongs")
    with pytest.raises(canonpose.InvalidArgument, match="there is no camera c"):
        canonpose.Sequence(SKELETON, "s", {"a": np.zeros((2, 17, 2))}, image_size={"c": (3, 4)})
    with pytest.raises(canonpose.InvalidArgument, match="`image_size` of b: expected width and height"):
        canonpose.Sequence(SKELETON, "s", {name: np.zeros((2, 17, 2)) for name in "ab"}, image_size={"a": (3, 4)})
    with pytest.raises(canonpose.InvalidArgument, match=r"`keypoints`: expected an array of shape \(2, 17, 2\), found \(3, 17, 2\)"):
        canonpose.Sequence(SKELETON, "s", {"a": np.zeros((2, 17, 2)), "b": np.zeros((3, 17, 2))}, image_size=(3, 4))


def test_a_dataset_is_what_was_put_in(tmp_path):
    keypoints = np.random.default_rng(2).uniform(0, 1000, (4, 17, 2))
    keypoints[1, 2] = np.nan
    camera = canonpose.Camera(K=np.diag([900, 900, 1]), R=np.eye(3), t=[0, 0, 4000], distortion=[0.1, 0.02])
    sequence = canonpose.Sequence(SKELETON, "walk", {"a": keypoints, "b": keypoints + 5}, fps=25, subject="Ann",
                                  image_size={"a": (1000, 800), "b": (640, 480)}, calibration={"a": [camera], "b": [camera]},
                                  truth={"a": np.ones((4, 17, 3))}, confidence={"b": np.full((4, 17), 0.25)})
    path = tmp_path / "data.h5"
    canonpose.Dataset([sequence]).write(path)
    read = canonpose.read_dataset(str(path)).sequences["walk"]
    assert (len(read), read.fps, read.subject, read.static_cameras) == (4, 25, "Ann", True)
    np.testing.assert_allclose(read.cameras["a"].keypoints, keypoints, rtol=1e-6)
    assert read.cameras["a"].confidence[1, 2] == 0 and read.cameras["a"].confidence[0, 2] == 1
    assert read.cameras["b"].confidence[0, 0] == 0.25 and read.cameras["b"].confidence[1, 2] == 0
    assert tuple(read.cameras["a"].image_size) == (1000, 800)
    assert read.cameras["a"].truth.positions[3, 3, 2] == 1 and read.cameras["b"].truth is None
    assert read.cameras["a"].solved is None
    again = read.cameras["b"].calibration[0]
    np.testing.assert_allclose(again.K, camera.K)
    np.testing.assert_allclose(again.distortion, [0.1, 0.02, 0, 0, 0])
    np.testing.assert_allclose(again.project([[0, 0, 0], [0, 0, -5000]]), [[0, 0], [np.nan, np.nan]])


def test_a_dataset_of_h5py_is_read(tmp_path):
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "data.h5", "w") as file:
        file.attrs.update({"format": "canonpose-dataset", "version": 1})
        skeleton = file.create_group("skeleton")
        skeleton.attrs["joints"] = list(SKELETON.joints)
        skeleton.attrs["parents"] = np.array(SKELETON.parents, np.int32)
        skeleton.attrs["root"] = np.int32(0)
        skeleton.attrs["mirror"] = np.array(SKELETON.mirror, np.int32)
        sequence = file.create_group("sequences/walk")
        sequence.attrs.update({"subject": "Ann", "fps": 25.0, "static_cameras": 1})
        for name in "ab":
            camera = sequence.create_group("cameras/" + name)
            camera.attrs["image_size"] = np.array([640, 480], np.int32)
            camera["keypoints"] = np.full((3, 17, 2), 9, np.float32)
            camera["confidence"] = np.ones((3, 17), np.float32)
    assert canonpose.read_dataset(tmp_path / "data.h5").sequences["walk"].cameras["b"].keypoints[2, 1, 0] == 9


def test_scenes(tmp_path):
    poses, positions = person()
    camera = canonpose.SceneCamera("a", [canonpose.Camera(np.eye(3), np.eye(3), [0, 0, 3])], (640, 480))
    canonpose.Scene([poses], [camera], name="walk", up="the tripod", floor="a level",
                    scale="a tape measure").write(tmp_path / "scene.h5")
    scene, = canonpose.read_scenes(tmp_path / "scene.h5")
    assert (scene.name, scene.up, scene.floor, scene.scale) == ("walk", "the tripod", "a level", "a tape measure")
    np.testing.assert_array_equal(scene.people[0].positions, positions)
    assert scene.people[0].unit == "mm" and scene.cameras[0].used
    np.testing.assert_array_equal(scene.cameras[0].calibration[0].t, [0, 0, 3])
    with pytest.raises(canonpose.InvalidArgument, match="`people`: expected poses of the same frames"):
        canonpose.Scene([poses, person(4)[0]])


def test_scenes_are_exported(tmp_path):
    poses, positions = person()
    scene = canonpose.Scene([poses], name="walk", up="the tripod", scale="a tape measure")
    canonpose.export(scene, tmp_path / "walk.npz", unit="mm")
    assert any(value.shape[-3:] == (5, 17, 3) for value in np.load(tmp_path / "walk.npz").values())
    scene.write(tmp_path / "scene.h5")
    canonpose.export(tmp_path / "scene.h5", tmp_path / "walk.trc", processing="nothing at all")
    assert (tmp_path / "walk.trc").read_text().startswith("PathFileType")
    with pytest.raises(canonpose.InvalidArgument, match="expected one of"):
        canonpose.export(scene, tmp_path / "walk.docx")
    with pytest.raises(canonpose.InvalidArgument, match="`up`: expected y or z"):
        canonpose.export(scene, tmp_path / "walk.trc", up="x")
    with pytest.raises(canonpose.InvalidArgument, match="holds one person"):
        canonpose.export(canonpose.Scene([poses, poses]), tmp_path / "walk.trc")


def test_errors_say_what_is_wrong(tmp_path):
    with pytest.raises(canonpose.BadInput, match="missing.h5") as raised:
        canonpose.read_dataset(tmp_path / "missing.h5")
    assert isinstance(raised.value, canonpose.Error) and isinstance(raised.value, RuntimeError)
    (tmp_path / "text.h5").write_text("this is no HDF5")
    with pytest.raises(canonpose.BadInput, match="text.h5"):
        canonpose.read_scenes(tmp_path / "text.h5")
    assert issubclass(canonpose.InvalidArgument, ValueError)
    assert all(issubclass(kind, canonpose.Error) for kind in (canonpose.ComputationFailed, canonpose.Stopped))


def test_stubs_name_everything_that_is_there():
    import ast
    stubs = ast.parse((pathlib.Path(canonpose.__file__).parent / "__init__.pyi").read_text())
    classes = {node.name: node for node in stubs.body if isinstance(node, ast.ClassDef)}
    functions = {node.name for node in stubs.body if isinstance(node, ast.FunctionDef)}
    public = {name: value for name, value in vars(canonpose).items() if not name.startswith("_")}
    for name in {"LiftedPoses", "Model"} - set(public):  # a build without LibTorch
        with pytest.raises(canonpose.InvalidArgument, match="without LibTorch"):
            canonpose.open_model("run")
        del classes[name]
    assert set(public) == set(classes) | functions
    for name, value in public.items():
        assert value.__doc__, name
        if name in classes and not issubclass(value, Exception):
            stubbed = {getattr(node, "name", getattr(getattr(node, "target", None), "id", None)) for node in classes[name].body}
            there = {member for member in vars(value) if not member.startswith("_")} | (stubbed & {"__init__", "__len__"})
            assert stubbed == there, name
