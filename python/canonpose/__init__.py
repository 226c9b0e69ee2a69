"""3D human pose from several uncalibrated cameras.

A recording of keypoints becomes 3D poses and cameras::

    import canonpose

    dataset = canonpose.import_keypoints("openpose", "recording/")
    solved = canonpose.solve(dataset)
    person = solved.scenes[0].people[0]      # person.positions is a NumPy array (T, J, 3)

Messages go to the logger "canonpose" of the module logging. Failures are subclasses of canonpose.Error. Long work releases the
interpreter's lock, calls ``progress(label, done, total, detail)`` if it is given, and is stopped by Ctrl-C, or by what ``progress``
raises.
"""
from ._core import *  # noqa: F401,F403
from ._core import __version__  # noqa: F401
