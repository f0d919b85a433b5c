"""Run as a process of its own: compiles one MJCF file within limits, and writes the compiled model to standard output.

It imports nothing of ours, so that it starts fast. Arguments: the file, and the seconds of processor time.
Exit codes: 0 compiled; 3 not compiled, and standard error says why. What the limits end has none of these.
"""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's names come from a compiled module that ships no type stubs)

from __future__ import annotations

import signal
import sys
from contextlib import suppress
from pathlib import Path

MEGABYTES = 400  # beside what the engine itself takes
REFUSED = 3  # exit code
TIMER = getattr(signal, "SIGPROF", 0)  # ends it when its time is over


def limit(seconds: float) -> None:
    """End this process when it takes more, where the system can do that."""
    try:
        import resource

        pages = int(Path("/proc/self/statm").read_text().split()[0])
        most = pages * resource.getpagesize() + MEGABYTES * 2**20
        resource.setrlimit(resource.RLIMIT_AS, (most, most))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    except (ImportError, OSError, ValueError):  # no Linux: the reader's clock still ends it
        pass
    with suppress(AttributeError):  # Windows
        signal.signal(TIMER, signal.SIG_DFL)
        signal.setitimer(signal.ITIMER_PROF, seconds)


def main() -> None:
    import mujoco
    import numpy as np

    name, seconds = sys.argv[1:]
    limit(float(seconds))
    try:
        model = mujoco.MjModel.from_xml_path(name)
    except ValueError as error:
        sys.stderr.buffer.write(str(error).encode(errors="replace"))
        sys.exit(REFUSED)
    data = np.empty(mujoco.mj_sizeModel(model), np.uint8)
    mujoco.mj_saveModel(model, None, data)
    sys.stdout.buffer.write(data.tobytes())


if __name__ == "__main__":
    main()
