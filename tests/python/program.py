# SPDX-License-Identifier: Apache-2.0
"""The program tuina beside the module tuina: both must say the same."""
import json, os, subprocess, tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BINARY = os.environ["TUINA_BINARY"]


def run(*words):
    return subprocess.run([BINARY, *map(str, words)], capture_output=True, text=True,
                          cwd=tempfile.gettempdir())


def answer(*words):
    """The JSON that a verb answers."""
    done = run(*words, "--json", "--quiet")
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def timeless(value):
    """Without the times that computing took, which no two runs share."""
    if isinstance(value, dict):
        return {key: timeless(kept) for key, kept in value.items() if key not in ("compute_ms", "real_time_factor", "late_ms")}
    return [timeless(kept) for kept in value] if isinstance(value, list) else value
