"""Recordings that several tests use: made once, since solving takes seconds."""
import pytest

import canonpose


@pytest.fixture(scope="session")
def dataset():
    """Someone who walks for two seconds before four cameras."""
    return canonpose.simulate(subjects=1, clips=1, seconds=2, activities=["gait"], noise=0.3, seed=1)


@pytest.fixture(scope="session")
def progress():
    """What `solved` reported while it was made."""
    return []


@pytest.fixture(scope="session")
def solved(dataset, progress):
    return canonpose.solve(dataset, threads=1, progress=lambda *state: progress.append(state))
