"""Machine code is kept between processes in little room, and nowhere without a warning where nothing can be written."""

import os
import subprocess
import sys

import pytest

PROGRAM = """
import heyoka, sympy
from canon import Hamiltonian, propagate
{before}
q, p = sympy.symbols("q p", real=True)
print(propagate(Hamiltonian(p**2 / 2 - sympy.cos(q), [q], [p]), (0, 1), [1.0, 0.0]).y.tobytes().hex())
print(heyoka.llvm_state.get_diskcache_enabled())
print(heyoka.llvm_state.get_diskcache_path())
{after}
"""


def told(home, before="", after=""):
    environment = {**os.environ, "HOME": str(home), "PYTHONPATH": os.pathsep.join(sys.path)}
    environment.pop("XDG_CACHE_HOME", None)
    program = PROGRAM.format(before=before, after=after)
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True, env=environment
    )
    assert done.stderr == ""
    return done.stdout.splitlines()


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="the folder of another system")
def test_machine_code_is_kept_in_little_room(tmp_path):
    states, enabled, folder, most, *_ = told(tmp_path, after="print(heyoka.llvm_state.get_diskcache_limit())")
    assert (enabled, most) == ("True", str(128 * 2**20))
    assert folder.startswith(str(tmp_path))
    assert folder.endswith("canon")
    assert any(tmp_path.rglob("canon/cache.db"))
    again, *_ = told(tmp_path)
    assert again == states


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="the folder of another system")
def test_where_nothing_can_be_written_nothing_is_kept_and_nothing_is_said(tmp_path):
    nowhere = tmp_path / "file"
    nowhere.touch()
    states, enabled, _ = told(nowhere)
    assert enabled == "False"
    assert states == told(tmp_path)[0]


def test_who_keeps_nothing_or_keeps_it_elsewhere_goes_on_doing_so(tmp_path):
    _, enabled, folder = told(tmp_path, before="heyoka.llvm_state.set_diskcache_enabled(False)")
    assert enabled == "False"
    assert not folder.endswith("canon")
    where = f"heyoka.llvm_state.set_diskcache_path({str(tmp_path / 'mine')!r})"
    assert told(tmp_path, before=where)[2] == str(tmp_path / "mine" / "canon")
