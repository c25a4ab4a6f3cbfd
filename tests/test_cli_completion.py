"""``canon completion``: what a shell offers is what the commands read."""

import re
import shlex
import subprocess

import pytest

from canon.cli import COMMANDS, main
from canon.command.completion import places
from canon.scene import names

SHELLS = ("bash", "zsh", "fish")


@pytest.fixture
def script(capsys):
    def printed(shell):
        assert main(["completion", shell]) == 0
        return capsys.readouterr().out

    return printed


def offered(script, *words, cwd=None):
    """What bash offers for the last of the words."""
    line = " ".join(shlex.quote(word) for word in words)
    asked = f'COMP_WORDS=({line}); COMP_CWORD={len(words) - 1}; _canon; printf "%s\\n" "${{COMPREPLY[@]}}"'
    done = subprocess.run(
        ["bash", "--norc", "-c", f"{script}\n{asked}"], capture_output=True, text=True, check=True, cwd=cwd
    )
    assert done.stderr == ""
    return set(done.stdout.split("\n")) - {""}


def test_bash_offers_what_can_follow(script):
    bash = script("bash")
    assert offered(bash, "canon", "") == set(COMMANDS)
    assert offered(bash, "canon", "dr") == {"drift"}
    assert offered(bash, "canon", "drift", "") == {*names(), "list"}
    assert offered(bash, "canon", "drift", "kep") == {"kepler"}
    assert offered(bash, "canon", "drift", "kepler", "--method", "kahan-li-") == {"kahan-li-6", "kahan-li-8"}
    assert offered(bash, "canon", "drift", "kepler", "--precision", "d") == {"double", "double-double"}
    assert offered(bash, "canon", "drift", "kepler", "--step", "") == set()
    assert offered(bash, "canon", "study", "r") == {"run", "resume", "report"}
    assert offered(bash, "canon", "study", "resume", "--s") == set()
    assert offered(bash, "canon", "study", "run", "--s") == {"--store", "--share"}
    assert offered(bash, "canon", "completion", "") == set(SHELLS)


def test_bash_offers_files_where_files_are_read_or_written(script, tmp_path):
    (tmp_path / "my answers.toml").touch()
    bash = script("bash")
    for words in (["check"], ["check", "--html"], ["drift", "kepler", "--plot"], ["study", "run", "--store"]):
        assert offered(bash, "canon", *words, "my", cwd=tmp_path) == {"my answers.toml"}
    assert offered(bash, "canon", "choose", "my", cwd=tmp_path) == set()


def test_every_option_of_the_help_is_offered_in_every_shell(script, capsys):
    scripts = {shell: script(shell) for shell in SHELLS}
    for place in places():
        with pytest.raises(SystemExit):
            main([*place.words[1:], "--help"])
        shown = set(re.findall(r"^  (?:-h, )?(--[\w-]+)", capsys.readouterr().out, re.MULTILINE))
        assert shown == {flag for flag in place.flags if flag.startswith("--")}
        for name in shown:
            assert name in scripts["bash"]
            assert f"{name}:" in scripts["zsh"]
            assert f" -l {name[2:]}" in scripts["fish"]
    for text in scripts.values():
        assert all(name in text for name in names())


def test_quotes_in_the_help_stay_quotes(script):
    """The help says one's; each word of zsh and of fish is closed again."""
    assert "show one'\"'\"'s equations" in script("zsh")
    assert "show one\\'s equations" in script("fish")
    assert subprocess.run(["bash", "-n", "-c", script("bash")], check=False).returncode == 0


def test_another_shell_is_refused(capsys):
    with pytest.raises(SystemExit):
        main(["completion", "tcsh"])
    told = capsys.readouterr().err
    assert "'tcsh'" in told
    assert all(shell in told for shell in SHELLS)
