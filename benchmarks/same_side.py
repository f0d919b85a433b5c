"""One side of `same.py`: runs commands of the equipoise on its path in one process, a line of JSON in, a line out.

Only the command line is used, so that a version whose modules have other names can be asked the same.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import sys
import time
from pathlib import Path
from typing import Any


def run(argv: list[str], files: dict[str, str]) -> dict[str, Any]:
    """What the command says, after writing the files that it reads; `-o` names the file that it writes."""
    from equipoise.cli import main

    for name, text in files.items():
        Path(name).write_text(text)
    out, err, code = io.StringIO(), io.StringIO(), 0
    sys.argv = ["equipoise", *argv]
    start = time.process_time()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            main()
        except SystemExit as end:
            code = end.code if isinstance(end.code, int) else int(end.code is not None)
    seconds = time.process_time() - start  # of the processor: what else the machine does counts less
    made = Path(argv[argv.index("-o") + 1]) if "-o" in argv else None
    text = made.read_text() if made is not None and made.is_file() else None
    return {"code": code, "out": out.getvalue(), "err": err.getvalue(), "made": text, "seconds": seconds}


def main() -> None:
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # what a library writes past Python is no answer
    import equipoise

    print(json.dumps(str(equipoise.__file__)), file=answers, flush=True)
    for line in sys.stdin:
        print(json.dumps(run(**json.loads(line))), file=answers, flush=True)


if __name__ == "__main__":
    main()
