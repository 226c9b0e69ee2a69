"""Analysis and filters."""
import numpy as np
import pytest

import canonpose

LEG = canonpose.Skeleton(["RHip", "RKnee", "RAnkle"], [-1, 0, 1])


def bending_leg(degrees):
    angle = np.radians(degrees)
    positions = np.zeros((len(degrees), 3, 3))
    positions[:, 0, 2] = 900
    positions[:, 1, 2] = 450
    positions[:, 2, 0] = -400 * np.sin(angle)
    positions[:, 2, 2] = 450 - 400 * np.cos(angle)
    return canonpose.PoseSequence(LEG, positions, fps=100)


def test_knee_angles_are_exact():
    degrees = np.linspace(0, 120, 30)
    analysis = canonpose.analyse(bending_leg(degrees))
    np.testing.assert_allclose(analysis.angles["knee_angle_r"], degrees, atol=0.01)
    np.testing.assert_allclose(analysis.segment_lengths["shank_length_r"], 400, rtol=1e-6)


def test_filters_leave_their_input_as_it_is():
    degrees = 40 + 5 * (-1.0) ** np.arange(60)
    person = bending_leg(degrees)
    before = person.positions.copy()
    person.positions[20:24] = np.nan
    smooth = canonpose.filtered(person, cutoff_hz=6, longest_gap_seconds=0.05)
    assert np.isnan(person.positions[20:24]).all() and np.isfinite(smooth.positions).all()
    assert (smooth.confidence[20:24] == 0).sum() == 0 or (smooth.confidence[20:24] == 0).all()
    assert np.ptp(canonpose.analyse(smooth).angles["knee_angle_r"][5:15]) < 1 < np.ptp(degrees)
    np.testing.assert_array_equal(person.positions[:20], before[:20])
    with pytest.raises(canonpose.InvalidArgument, match="half the frame rate"):
        canonpose.filtered(person, cutoff_hz=50)


def test_scipy_agrees():
    signal = pytest.importorskip("scipy.signal")
    person = bending_leg(60 + 20 * np.sin(np.arange(80) / 3) + np.random.default_rng(3).normal(0, 2, 80))
    tangent = np.tan(np.pi * 6 / 100) / (np.sqrt(2) - 1) ** 0.25
    b, a = signal.butter(2, 2 / np.pi * np.arctan(tangent))
    expected = signal.filtfilt(b, a, person.positions[:, 2, 0].astype(float))
    np.testing.assert_allclose(canonpose.filtered(person, cutoff_hz=6).positions[:, 2, 0], expected, atol=1e-3)
